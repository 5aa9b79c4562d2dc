#include "lobe/io/vtk_xml.h"

#include <algorithm>

#include "lobe/error.h"

namespace lobe::io {
namespace {

// Cuts off the appended data. Returns the XML without it, with its tags closed.
std::string cut_appended(std::string_view bytes, VtuContext& context) {
  const std::size_t begin = bytes.find("<AppendedData");
  if (begin == bytes.npos) return std::string(bytes);
  const std::size_t tag_end = bytes.find('>', begin);
  const std::size_t mark = tag_end == bytes.npos ? bytes.npos : bytes.find('_', tag_end);
  if (mark == bytes.npos)
    throw InputError(context.file + ": AppendedData", "has no '_' before its data; the file is truncated");
  const std::string_view tag = bytes.substr(begin, tag_end - begin);
  context.appended_base64 = tag.find("base64") != tag.npos;
  context.appended = bytes.substr(mark + 1);
  return std::string(bytes.substr(0, begin)) + "</VTKFile>";
}

void read_attributes(const pugi::xml_node& root, const std::string& expected, VtuContext& context) {
  const auto attribute = [&](const char* name, const char* missing) {
    return std::string(root.attribute(name).as_string(missing));
  };
  const auto refuse = [&](const std::string& what, const std::string& instead) {
    throw InputError(place_of(context, root), what + ", expected " + instead);
  };
  const std::string type = attribute("type", ""), order = attribute("byte_order", "LittleEndian"),
                    header = attribute("header_type", "UInt32"), compressor = attribute("compressor", "");
  if (type != expected) refuse("type '" + type + "'", expected);
  if (order != "LittleEndian" && order != "BigEndian") refuse("byte_order '" + order + "'", "LittleEndian");
  if (header != "UInt32" && header != "UInt64") refuse("header_type '" + header + "'", "UInt32 or UInt64");
  if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
    refuse("compressor '" + compressor + "'", "vtkZLibDataCompressor or none; save the file with ZLib");
  context.swap = (order == "LittleEndian") != (std::endian::native == std::endian::little);
  context.wide_headers = header == "UInt64";
  context.zlib = !compressor.empty();
}

}  // namespace

pugi::xml_node vtk_child(const VtkXml& xml, const pugi::xml_node& parent, const char* name) {
  const pugi::xml_node node = parent.child(name);
  if (!node) throw InputError(place_of(xml.context, parent), std::string("has no <") + name + ">");
  return node;
}

void parse_vtk_xml(const std::string& name, std::string_view bytes, const std::string& type, VtkXml& xml) {
  VtuContext& context = xml.context;
  context.file = name;
  const std::string text = cut_appended(bytes, context);
  context.xml = bytes;
  const auto result = xml.document.load_buffer(text.data(), text.size());
  if (!result) {
    const auto end = bytes.begin() + std::clamp<std::ptrdiff_t>(result.offset, 0, std::ssize(bytes));
    throw InputError(
        context.file + ":" + std::to_string(1 + std::count(bytes.begin(), end, '\n')),
        std::string("is not XML: ") + result.description() + "; the file is truncated or damaged");
  }
  const pugi::xml_node root = xml.document.child("VTKFile");
  if (!root) throw InputError(context.file, "has no <VTKFile>; is this a VTK XML file?");
  read_attributes(root, type, context);
  const pugi::xml_node grid = vtk_child(xml, root, type.c_str());
  xml.piece = vtk_child(xml, grid, "Piece");
  if (xml.piece.next_sibling("Piece"))
    throw InputError(place_of(context, grid),
                     "has several pieces, expected one; merge them (ParaView: Merge Blocks, Clean to Grid)");
}

std::vector<double> read_vtk_array(const VtkXml& xml, const pugi::xml_node& section, const char* name) {
  const pugi::xml_node array = section.find_child_by_attribute("DataArray", "Name", name);
  if (!array)
    throw InputError(place_of(xml.context, section), std::string("has no DataArray '") + name + "'");
  return read_data_array(xml.context, array);
}

void check_vtk_count(const VtkXml& xml, const char* attribute, std::size_t found) {
  if (xml.piece.attribute(attribute).as_ullong(~0ULL) != found)
    throw InputError(place_of(xml.context, xml.piece),
                     std::string(attribute) + " is '" + xml.piece.attribute(attribute).value() + "', but " +
                         std::to_string(found) + " are in the file");
}

std::vector<double> read_vtk_points(const VtkXml& xml) {
  const pugi::xml_node array = vtk_child(xml, vtk_child(xml, xml.piece, "Points"), "DataArray");
  std::vector<double> coordinates = read_data_array(xml.context, array);
  if (coordinates.size() % 3)
    throw InputError(place_of(xml.context, array),
                     std::to_string(coordinates.size()) + " coordinates, expected three of each point");
  check_vtk_count(xml, "NumberOfPoints", coordinates.size() / 3);
  return coordinates;
}

VtkData read_vtk_data(const VtkXml& xml, const char* section, std::size_t items) {
  VtkData data;
  for (const pugi::xml_node array : xml.piece.child(section).children("DataArray")) {
    if (std::string_view(array.attribute("type").value()) == "String") continue;
    const std::vector<double> values = read_data_array(xml.context, array);
    const auto components = array.attribute("NumberOfComponents").as_ullong(1);
    if (components == 0 || values.size() % components || values.size() / components != items)
      throw InputError(place_of(xml.context, array), std::to_string(values.size()) + " numbers, expected " +
                                                         std::to_string(components) + " for each of " +
                                                         std::to_string(items) + " points or cells");
    data[array.attribute("Name").value()] = Eigen::Map<const Eigen::MatrixXd>(
        values.data(), static_cast<Eigen::Index>(components), static_cast<Eigen::Index>(items));
  }
  return data;
}

}  // namespace lobe::io
