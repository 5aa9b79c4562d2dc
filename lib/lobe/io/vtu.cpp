// VTK XML unstructured grids (VTK file formats, "XML file formats"): one piece, any encoding but LZ4 and
// LZMA.
#include <algorithm>

#include "lobe/error.h"
#include "lobe/io/vtk_cells.h"
#include "lobe/io/vtu_data.h"

namespace lobe::io {
namespace {

struct Parsed {
  VtuContext context;
  pugi::xml_document document;
  pugi::xml_node piece;
};

// Cuts the appended data away; returns the XML without it, closed again.
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

void read_attributes(const pugi::xml_node& root, VtuContext& context) {
  const auto attribute = [&](const char* name, const char* missing) {
    return std::string(root.attribute(name).as_string(missing));
  };
  const auto refuse = [&](const std::string& what, const std::string& expected) {
    throw InputError(place_of(context, root), what + ", expected " + expected);
  };
  const std::string type = attribute("type", ""), order = attribute("byte_order", "LittleEndian"),
                    header = attribute("header_type", "UInt32"), compressor = attribute("compressor", "");
  if (type != "UnstructuredGrid") refuse("type '" + type + "'", "UnstructuredGrid");
  if (order != "LittleEndian" && order != "BigEndian") refuse("byte_order '" + order + "'", "LittleEndian");
  if (header != "UInt32" && header != "UInt64") refuse("header_type '" + header + "'", "UInt32 or UInt64");
  if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
    refuse("compressor '" + compressor + "'", "vtkZLibDataCompressor or none; save the file with ZLib");
  context.swap = (order == "LittleEndian") != (std::endian::native == std::endian::little);
  context.wide_headers = header == "UInt64";
  context.zlib = !compressor.empty();
}

pugi::xml_node child(const VtuContext& context, const pugi::xml_node& parent, const char* name) {
  const pugi::xml_node node = parent.child(name);
  if (!node) throw InputError(place_of(context, parent), std::string("has no <") + name + ">");
  return node;
}

void parse(std::string_view bytes, const std::string& xml, Parsed& parsed) {
  VtuContext& context = parsed.context;
  context.xml = bytes;
  const auto result = parsed.document.load_buffer(xml.data(), xml.size());
  if (!result) {
    const auto end = bytes.begin() + std::clamp<std::ptrdiff_t>(result.offset, 0, std::ssize(bytes));
    throw InputError(
        context.file + ":" + std::to_string(1 + std::count(bytes.begin(), end, '\n')),
        std::string("is not XML: ") + result.description() + "; the file is truncated or damaged");
  }
  const pugi::xml_node root = parsed.document.child("VTKFile");
  if (!root) throw InputError(context.file, "has no <VTKFile>; is this a VTU file?");
  read_attributes(root, context);
  const pugi::xml_node grid = child(context, root, "UnstructuredGrid");
  parsed.piece = child(context, grid, "Piece");
  if (parsed.piece.next_sibling("Piece"))
    throw InputError(place_of(context, grid),
                     "has several pieces, expected one; merge them (ParaView: Merge Blocks, Clean to Grid)");
}

std::vector<double> cell_array(const VtuContext& context, const pugi::xml_node& cells, const char* name) {
  const pugi::xml_node array = cells.find_child_by_attribute("DataArray", "Name", name);
  if (!array) throw InputError(place_of(context, cells), std::string("has no DataArray '") + name + "'");
  return read_data_array(context, array);
}

void check_count(const VtuContext& context, const pugi::xml_node& piece, const char* attribute,
                 std::size_t found) {
  if (piece.attribute(attribute).as_ullong(~0ULL) != found)
    throw InputError(place_of(context, piece), std::string(attribute) + " is '" +
                                                   piece.attribute(attribute).value() + "', but " +
                                                   std::to_string(found) + " are in the file");
}

RawMesh read_points(const Parsed& parsed) {
  const pugi::xml_node points = child(parsed.context, parsed.piece, "Points");
  const pugi::xml_node array = child(parsed.context, points, "DataArray");
  RawMesh raw;
  raw.coordinates = read_data_array(parsed.context, array);
  if (raw.coordinates.size() % 3)
    throw InputError(place_of(parsed.context, array),
                     std::to_string(raw.coordinates.size()) + " coordinates, expected three of each point");
  check_count(parsed.context, parsed.piece, "NumberOfPoints", raw.coordinates.size() / 3);
  return raw;
}

VtkCells read_cells(const Parsed& parsed) {
  const pugi::xml_node node = child(parsed.context, parsed.piece, "Cells");
  VtkCells cells;
  cells.connectivity = cell_array(parsed.context, node, "connectivity");
  cells.ends = cell_array(parsed.context, node, "offsets");
  cells.types = cell_array(parsed.context, node, "types");
  check_count(parsed.context, parsed.piece, "NumberOfCells", cells.types.size());
  return cells;
}

using Data = std::map<std::string, Eigen::MatrixXd>;

// All numeric arrays of PointData or CellData.
Data read_data(const Parsed& parsed, const char* section, std::size_t items) {
  Data data;
  for (const pugi::xml_node array : parsed.piece.child(section).children("DataArray")) {
    if (std::string_view(array.attribute("type").value()) == "String") continue;
    const std::vector<double> values = read_data_array(parsed.context, array);
    const auto components = array.attribute("NumberOfComponents").as_ullong(1);
    if (components == 0 || values.size() % components || values.size() / components != items)
      throw InputError(place_of(parsed.context, array),
                       std::to_string(values.size()) + " numbers, expected " + std::to_string(components) +
                           " for each of " + std::to_string(items) + " points or cells");
    data[array.attribute("Name").value()] = Eigen::Map<const Eigen::MatrixXd>(
        values.data(), static_cast<Eigen::Index>(components), static_cast<Eigen::Index>(items));
  }
  return data;
}

void take_labels(Data& cell_data, const std::vector<std::size_t>& tets, const std::string& place,
                 RawMesh& raw) {
  for (const char* name : label_names) {
    const auto found = cell_data.find(name);
    if (found == cell_data.end() || found->second.rows() != 1) continue;
    const Eigen::MatrixXd& values = found->second;
    raw.labels = labels_of({values.data(), values.data() + values.size()}, tets, place + ": " + name);
    if (std::string_view(name) == "label") cell_data.erase(found);
    return;
  }
}

Data only_tetrahedra(const Data& cell_data, const std::vector<std::size_t>& tets) {
  Data data;
  for (const auto& [name, values] : cell_data) data[name] = values(Eigen::all, tets);
  return data;
}

}  // namespace

MeshFile read_vtu(const std::string& name, std::string_view bytes) {
  Parsed parsed;
  parsed.context.file = name;
  const std::string xml = cut_appended(bytes, parsed.context);
  parse(bytes, xml, parsed);
  RawMesh raw = read_points(parsed);
  const VtkCells cells = read_cells(parsed);
  const auto tets = add_tetrahedra(cells, name, raw);
  Data point_data = read_data(parsed, "PointData", raw.coordinates.size() / 3);
  Data cell_data = read_data(parsed, "CellData", cells.types.size());
  take_labels(cell_data, tets, name, raw);
  MeshFile file = finish(std::move(raw), name);
  file.point_data = std::move(point_data);
  file.cell_data = only_tetrahedra(cell_data, tets);
  return file;
}

}  // namespace lobe::io
