#include "lobe/io/vtk_xml_write.h"

#include <cmath>

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

void write_tags(std::ostream& out, const std::vector<VtkBlock>& blocks) {
  std::uint64_t offset = 0;
  std::string open;
  for (const VtkBlock& block : blocks) {
    if (open != block.section) {
      if (!open.empty()) out << "   </" << open << ">\n";
      out << "   <" << block.section << ">\n";
      open = block.section;
    }
    out << "    <DataArray" << block.attributes << " format=\"appended\" offset=\"" << offset << "\"/>\n";
    offset += sizeof(std::uint64_t) + block.size;
  }
  out << "   </" << open << ">\n";
}

}  // namespace

std::string vtk_attributes(const std::string& name, const char* type, Eigen::Index components) {
  return " type=\"" + std::string(type) + "\" Name=\"" + xml_escaped(name) + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\"";
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
      << vtk_byte_order << "\" header_type=\"UInt64\">\n <" << type << ">\n  <Piece" << piece << ">\n";
  write_tags(out, blocks);
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
