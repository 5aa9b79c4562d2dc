#include "lobe/io/vtk_xml_write.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/text.h"

namespace lobe::io {
namespace {

std::vector<Index> whole_numbers(const DataArray& array, const std::string& place) {
  std::vector<Index> numbers;
  numbers.reserve(static_cast<std::size_t>(array.values.size()));
  for (const double value : array.values.reshaped()) {
    if (!(std::abs(value) <= 2147483647.0))
      throw InputError(place, "array '" + array.name + "' holds " + exact(value) + ", which is no int32");
    numbers.push_back(static_cast<Index>(value));
  }
  return numbers;
}

// Of blocks of which the first stands at `offset` in the appended data.
void write_tags(std::ostream& out, std::span<const VtkBlock> blocks, const char* indent,
                std::uint64_t& offset) {
  std::string open;
  for (const VtkBlock& block : blocks) {
    if (open != block.section) {
      if (!open.empty()) out << indent << "</" << open << ">\n";
      out << indent << "<" << block.section << ">\n";
      open = block.section;
    }
    const char* const tag =
        open == "FieldData" ? " <Array" : " <DataArray";  // VTK's words for strings, numbers
    out << indent << tag << block.attributes << " format=\"appended\" offset=\"" << offset << "\"/>\n";
    offset += sizeof(std::uint64_t) + block.size;
  }
  if (!open.empty()) out << indent << "</" << open << ">\n";
}

}  // namespace

std::string vtk_attributes(const std::string& name, const char* type, Eigen::Index components) {
  return " type=\"" + std::string(type) + "\" Name=\"" + xml_escaped(name) + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\"";
}

VtkBlock vtk_strings(const std::string& name, const std::vector<std::string>& strings) {
  std::string bytes;
  for (const std::string& text : strings) bytes.append(text.c_str(), text.size() + 1);
  const std::size_t size = bytes.size();
  return {"FieldData",
          " type=\"String\" Name=\"" + xml_escaped(name) + "\" NumberOfTuples=\"" +
              std::to_string(strings.size()) + "\"",
          std::move(bytes), nullptr, size};
}

VtkBlock vtk_data_block(const char* section, const DataArray& array, Index items, const std::string& place) {
  if (array.values.cols() != items || array.values.rows() < 1)
    throw InputError(place, "array '" + array.name + "' has " + std::to_string(array.values.cols()) +
                                " columns, expected " + std::to_string(items) + " for " + section);
  const Eigen::Index rows = array.values.rows();
  if (array.type == DataArray::Type::float64)
    return vtk_in_place(section, vtk_attributes(array.name, "Float64", rows), array.values);
  if (array.type == DataArray::Type::int32)
    return vtk_converted(section, vtk_attributes(array.name, "Int32", rows), whole_numbers(array, place));
  std::vector<float> values(static_cast<std::size_t>(array.values.size()));
  Eigen::Map<Eigen::MatrixXf>(values.data(), rows, array.values.cols()) = array.values.cast<float>();
  return vtk_converted(section, vtk_attributes(array.name, "Float32", rows), values);
}

VtkBlock vtk_offsets(const char* section, std::size_t cells, int vertices) {
  std::vector<std::int64_t> ends(cells);
  for (std::size_t c = 0; c < cells; ++c) ends[c] = vertices * static_cast<std::int64_t>(c + 1);
  return vtk_converted(section, vtk_attributes("offsets", "Int64", 1), ends);
}

void write_vtk_xml(const std::filesystem::path& file, const std::string& type, const std::string& piece,
                   const std::vector<VtkBlock>& blocks) {
  AtomicFile target(file);
  std::ostream& out = target.stream();
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"" << type << "\" version=\"1.0\" byte_order=\""
      << vtk_byte_order << "\" header_type=\"UInt64\">\n <" << type << ">\n";
  const auto is_field = [](const VtkBlock& block) { return std::string_view(block.section) == "FieldData"; };
  const std::span<const VtkBlock> all(blocks);
  const auto fields = std::size_t(std::find_if_not(blocks.begin(), blocks.end(), is_field) - blocks.begin());
  std::uint64_t offset = 0;
  write_tags(out, all.first(fields), "  ", offset);
  out << "  <Piece" << piece << ">\n";
  write_tags(out, all.subspan(fields), "   ", offset);
  out << "  </Piece>\n </" << type << ">\n <AppendedData encoding=\"raw\">\n  _";
  for (const VtkBlock& block : blocks) {
    const std::uint64_t size = block.size;
    target.write(&size, sizeof size);
    target.write(block.data ? block.data : block.owned.data(), block.size);
  }
  out << "\n </AppendedData>\n</VTKFile>\n";
  target.commit();
}

}  // namespace lobe::io
