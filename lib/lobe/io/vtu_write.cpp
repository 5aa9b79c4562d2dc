// VTU and PVD files out. All arrays of a VTU are appended raw, each after its size in a UInt64.
#include <bit>
#include <cmath>

#include "lobe/error.h"
#include "lobe/io/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr const char* byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

// An array as it goes into the file: its tag, and its bytes.
struct Block {
  const char* section;
  std::string attributes;
  std::string owned;  // bytes converted for the file, or
  const void* data;   // bytes as they are in memory
  std::size_t size;
};

std::string attributes(const std::string& name, const char* type, Eigen::Index components) {
  return " type=\"" + std::string(type) + "\" Name=\"" + io::xml_escaped(name) + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\"";
}

template <class T>
Block converted(const char* section, std::string tag, const std::vector<T>& values) {
  Block block{section, std::move(tag), std::string(), nullptr, values.size() * sizeof(T)};
  block.owned.assign(reinterpret_cast<const char*>(values.data()), block.size);
  return block;
}

template <class Matrix>
Block in_place(const char* section, std::string tag, const Matrix& values) {
  return {section, std::move(tag), std::string(), values.data(),
          static_cast<std::size_t>(values.size()) * sizeof(typename Matrix::Scalar)};
}

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

Block data_block(const char* section, const DataArray& array, Index items, const std::string& place) {
  if (array.values.cols() != items || array.values.rows() < 1)
    throw InputError(place, "array '" + array.name + "' has " + std::to_string(array.values.cols()) +
                                " columns, expected " + std::to_string(items) + " for " + section);
  const Eigen::Index rows = array.values.rows();
  if (array.type == DataArray::Type::float64)
    return in_place(section, attributes(array.name, "Float64", rows), array.values);
  if (array.type == DataArray::Type::int32)
    return converted(section, attributes(array.name, "Int32", rows), whole_numbers(array, place));
  std::vector<float> values(static_cast<std::size_t>(array.values.size()));
  Eigen::Map<Eigen::MatrixXf>(values.data(), rows, array.values.cols()) = array.values.cast<float>();
  return converted(section, attributes(array.name, "Float32", rows), values);
}

std::vector<Block> all_blocks(const std::string& place, const TetMesh& mesh,
                              const std::vector<DataArray>& point_data,
                              const std::vector<DataArray>& cell_data) {
  const auto tets = static_cast<std::size_t>(mesh.tet_count());
  std::vector<Block> blocks;
  for (const DataArray& array : point_data)
    blocks.push_back(data_block("PointData", array, mesh.vertex_count(), place));
  std::vector<int> labels = mesh.labels;
  if (labels.empty()) labels.assign(tets, 0);
  if (labels.size() != tets)
    throw InputError(place, std::to_string(labels.size()) + " labels for " + std::to_string(tets) +
                                " tetrahedra; give one per tetrahedron, or none");
  blocks.push_back(converted("CellData", attributes("label", "Int32", 1), labels));
  for (const DataArray& array : cell_data)
    blocks.push_back(data_block("CellData", array, mesh.tet_count(), place));
  blocks.push_back(in_place("Points", attributes("Points", "Float64", 3), mesh.points));
  blocks.push_back(in_place("Cells", attributes("connectivity", "Int32", 1), mesh.tets));
  std::vector<std::int64_t> ends(tets);
  for (std::size_t t = 0; t < tets; ++t) ends[t] = 4 * static_cast<std::int64_t>(t + 1);
  blocks.push_back(converted("Cells", attributes("offsets", "Int64", 1), ends));
  blocks.push_back(
      converted("Cells", attributes("types", "UInt8", 1), std::vector<std::uint8_t>(tets, 10)));  // VTK_TETRA
  return blocks;
}

void write_tags(std::ostream& out, const std::vector<Block>& blocks) {
  std::uint64_t offset = 0;
  std::string open;
  for (const Block& block : blocks) {
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

void write_vtu(const std::filesystem::path& file, const TetMesh& mesh,
               const std::vector<DataArray>& point_data, const std::vector<DataArray>& cell_data) {
  const std::vector<Block> blocks = all_blocks(file.string(), mesh, point_data, cell_data);
  io::AtomicFile target(file);
  std::ostream& out = target.stream();
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\""
      << byte_order << "\" header_type=\"UInt64\">\n <UnstructuredGrid>\n  <Piece NumberOfPoints=\""
      << mesh.vertex_count() << "\" NumberOfCells=\"" << mesh.tet_count() << "\">\n";
  write_tags(out, blocks);
  out << "  </Piece>\n </UnstructuredGrid>\n <AppendedData encoding=\"raw\">\n  _";
  for (const Block& block : blocks) {
    const std::uint64_t size = block.size;
    target.write(&size, sizeof size);
    target.write(block.data ? block.data : block.owned.data(), block.size);
  }
  out << "\n </AppendedData>\n</VTKFile>\n";
  target.commit();
}

void write_pvd(const std::filesystem::path& file, const std::vector<std::pair<double, std::string>>& frames) {
  io::AtomicFile target(file);
  std::ostream& out = target.stream();
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"" << byte_order
      << "\">\n <Collection>\n";
  for (const auto& [time, name] : frames)
    out << "  <DataSet timestep=\"" << exact(time) << "\" part=\"0\" file=\"" << io::xml_escaped(name)
        << "\"/>\n";
  out << " </Collection>\n</VTKFile>\n";
  target.commit();
}

}  // namespace lobe
