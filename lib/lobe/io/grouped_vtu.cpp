// VTU files out with triangles in groups, which are cells behind the tetrahedra.
#include "lobe/error.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/io/vtk_xml.h"
#include "lobe/io/vtk_xml_write.h"

namespace lobe {
namespace {

using namespace io;

std::vector<VtkBlock> blocks_of_names(const Groups& groups) {
  std::vector<std::string> surfaces, labels;
  for (const SurfaceGroup& group : groups.surfaces)
    if (!group.name.empty()) surfaces.push_back(std::to_string(group.number) + " " + group.name);
  for (const auto& [label, name] : groups.label_names)
    if (!name.empty()) labels.push_back(std::to_string(label) + " " + name);
  std::vector<VtkBlock> blocks;
  if (!surfaces.empty()) blocks.push_back(vtk_strings(vtu_surface_names, surfaces));
  if (!labels.empty()) blocks.push_back(vtk_strings(vtu_label_names, labels));
  return blocks;
}

// Values of the tetrahedra, and 0 for each triangle.
DataArray with_triangles(const DataArray& of_tets, std::size_t triangles, const TetMesh& mesh,
                         const std::string& place) {
  const Eigen::Index tets = mesh.tet_count(), rows = of_tets.values.rows();
  if (of_tets.values.cols() != tets)
    throw InputError(place, "array '" + of_tets.name + "' has " + std::to_string(of_tets.values.cols()) +
                                " columns, expected " + std::to_string(tets) + " for CellData");
  DataArray all{of_tets.name, Eigen::MatrixXd::Zero(rows, tets + Eigen::Index(triangles)), of_tets.type};
  all.values.leftCols(tets) = of_tets.values;
  return all;
}

// A triangle has the number of its group as label.
struct GroupedCells {
  std::vector<int> labels;
  std::vector<Index> connectivity;
  std::vector<std::int64_t> ends;
  std::vector<std::uint8_t> types;
};

GroupedCells cells_of(const TetMesh& mesh, const Groups& groups, const std::string& place) {
  constexpr std::uint8_t tetrahedron = 10, triangle = 5;  // VTK's numbers
  const auto tets = static_cast<std::size_t>(mesh.tet_count());
  GroupedCells cells;
  cells.labels = mesh.labels.empty() ? std::vector<int>(tets, 0) : mesh.labels;
  if (cells.labels.size() != tets)
    throw InputError(place, std::to_string(cells.labels.size()) + " labels for " + std::to_string(tets) +
                                " tetrahedra; give one per tetrahedron, or none");
  cells.connectivity.assign(mesh.tets.data(), mesh.tets.data() + mesh.tets.size());
  cells.types.assign(tets, tetrahedron);
  for (std::size_t t = 1; t <= tets; ++t) cells.ends.push_back(4 * static_cast<std::int64_t>(t));
  for (const SurfaceGroup& group : groups.surfaces)
    for (const auto& corners : group.triangles) {
      cells.labels.push_back(group.number);
      cells.connectivity.insert(cells.connectivity.end(), corners.begin(), corners.end());
      cells.types.push_back(triangle);
      cells.ends.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
    }
  return cells;
}

}  // namespace

void write_grouped_vtu(const std::filesystem::path& file, const TetMesh& mesh, const Groups& groups,
                       const std::vector<DataArray>& point_data, const std::vector<DataArray>& cell_data) {
  if (groups.empty()) return write_vtu(file, mesh, point_data, cell_data);
  const std::string place = file.string();
  const GroupedCells cells = cells_of(mesh, groups, place);
  const std::size_t triangles = cells.types.size() - static_cast<std::size_t>(mesh.tet_count());
  std::vector<DataArray> padded;
  if (mesh.fibres.cols() > 0)
    padded.push_back(with_triangles({"fibre", mesh.fibres}, triangles, mesh, place));
  for (const DataArray& array : cell_data) padded.push_back(with_triangles(array, triangles, mesh, place));

  std::vector<VtkBlock> blocks = blocks_of_names(groups);
  for (const DataArray& array : point_data)
    blocks.push_back(vtk_data_block("PointData", array, mesh.vertex_count(), place));
  blocks.push_back(vtk_converted("CellData", vtk_attributes("label", "Int32", 1), cells.labels));
  for (const DataArray& array : padded)
    blocks.push_back(vtk_data_block("CellData", array, static_cast<Index>(cells.types.size()), place));
  blocks.push_back(vtk_in_place("Points", vtk_attributes("Points", "Float64", 3), mesh.points));
  blocks.push_back(vtk_converted("Cells", vtk_attributes("connectivity", "Int32", 1), cells.connectivity));
  blocks.push_back(vtk_converted("Cells", vtk_attributes("offsets", "Int64", 1), cells.ends));
  blocks.push_back(vtk_converted("Cells", vtk_attributes("types", "UInt8", 1), cells.types));
  write_vtk_xml(file, "UnstructuredGrid",
                " NumberOfPoints=\"" + std::to_string(mesh.vertex_count()) + "\" NumberOfCells=\"" +
                    std::to_string(cells.types.size()) + "\"",
                blocks);
}

}  // namespace lobe
