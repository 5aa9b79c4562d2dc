// VTU and PVD files out.
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/vtk_xml_write.h"
#include "lobe/text.h"

namespace lobe {
namespace {

using namespace io;

std::vector<VtkBlock> all_blocks(const std::string& place, const TetMesh& mesh,
                                 const std::vector<DataArray>& point_data,
                                 const std::vector<DataArray>& cell_data) {
  const auto tets = static_cast<std::size_t>(mesh.tet_count());
  std::vector<VtkBlock> blocks;
  for (const DataArray& array : point_data)
    blocks.push_back(vtk_data_block("PointData", array, mesh.vertex_count(), place));
  std::vector<int> labels = mesh.labels;
  if (labels.empty()) labels.assign(tets, 0);
  if (labels.size() != tets)
    throw InputError(place, std::to_string(labels.size()) + " labels for " + std::to_string(tets) +
                                " tetrahedra; give one per tetrahedron, or none");
  blocks.push_back(vtk_converted("CellData", vtk_attributes("label", "Int32", 1), labels));
  if (mesh.fibres.cols() > 0) {
    if (mesh.fibres.cols() != mesh.tet_count())
      throw InputError(place, "give one fibre direction per tetrahedron, or none");
    blocks.push_back(vtk_in_place("CellData", vtk_attributes("fibre", "Float64", 3), mesh.fibres));
  }
  for (const DataArray& array : cell_data)
    blocks.push_back(vtk_data_block("CellData", array, mesh.tet_count(), place));
  blocks.push_back(vtk_in_place("Points", vtk_attributes("Points", "Float64", 3), mesh.points));
  blocks.push_back(vtk_in_place("Cells", vtk_attributes("connectivity", "Int32", 1), mesh.tets));
  blocks.push_back(vtk_offsets("Cells", tets, 4));
  blocks.push_back(vtk_converted("Cells", vtk_attributes("types", "UInt8", 1),
                                 std::vector<std::uint8_t>(tets, 10)));  // VTK_TETRA
  return blocks;
}

}  // namespace

void write_vtu(const std::filesystem::path& file, const TetMesh& mesh,
               const std::vector<DataArray>& point_data, const std::vector<DataArray>& cell_data) {
  write_vtk_xml(file, "UnstructuredGrid",
                " NumberOfPoints=\"" + std::to_string(mesh.vertex_count()) + "\" NumberOfCells=\"" +
                    std::to_string(mesh.tet_count()) + "\"",
                all_blocks(file.string(), mesh, point_data, cell_data));
}

void write_pvd(const std::filesystem::path& file, const std::vector<std::pair<double, std::string>>& frames) {
  io::AtomicFile target(file);
  std::ostream& out = target.stream();
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\""
      << vtk_byte_order << "\">\n <Collection>\n";
  for (const auto& [time, name] : frames)
    out << "  <DataSet timestep=\"" << exact(time) << "\" part=\"0\" file=\"" << io::xml_escaped(name)
        << "\"/>\n";
  out << " </Collection>\n</VTKFile>\n";
  target.commit();
}

}  // namespace lobe
