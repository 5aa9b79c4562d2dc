// VTK XML polygons: surfaces in and out.
#include "lobe/error.h"
#include "lobe/io/numeric.h"
#include "lobe/io/raw_mesh.h"
#include "lobe/io/surface_io.h"
#include "lobe/io/vtk_legacy.h"
#include "lobe/io/vtk_xml.h"
#include "lobe/io/vtk_xml_write.h"

namespace lobe {

using namespace io;

void io::write_vtk_triangles(const std::filesystem::path& file, const Mat3X<double>& points,
                             const Triangles& triangles, const std::vector<DataArray>& data) {
  const auto count = static_cast<std::size_t>(triangles.cols());
  const bool is_grid = file.extension() == ".vtu";
  const char* const cells = is_grid ? "Cells" : "Polys";
  std::vector<VtkBlock> blocks;
  for (const DataArray& array : data)
    blocks.push_back(vtk_data_block("CellData", array, static_cast<Index>(count), file.string()));
  blocks.push_back(vtk_in_place("Points", vtk_attributes("Points", "Float64", 3), points));
  blocks.push_back(vtk_in_place(cells, vtk_attributes("connectivity", "Int32", 1), triangles));
  blocks.push_back(vtk_offsets(cells, count, 3));
  if (is_grid) {
    blocks.push_back(vtk_converted(cells, vtk_attributes("types", "UInt8", 1),
                                   std::vector<std::uint8_t>(count, 5)));  // VTK_TRIANGLE
  }
  write_vtk_xml(file, is_grid ? "UnstructuredGrid" : "PolyData",
                " NumberOfPoints=\"" + std::to_string(points.cols()) + "\" NumberOf" + cells + "=\"" +
                    std::to_string(count) + "\"",
                blocks);
}

namespace {

// The cells of one kind, none where the file has no such element.
void add_cells(const VtkXml& xml, const std::string& name, const char* element, double type,
               Polygons& polygons) {
  const pugi::xml_node node = xml.piece.child(element);
  VtkCells cells;
  if (node) {
    cells.connectivity = read_vtk_array(xml, node, "connectivity");
    cells.ends = read_vtk_array(xml, node, "offsets");
  }
  const std::string count = "NumberOf" + std::string(element);
  if (xml.piece.attribute(count.c_str())) check_vtk_count(xml, count.c_str(), cells.ends.size());
  cells.types.assign(cells.ends.size(), type);
  add_polygons(cells, name + ": " + element, polygons);
}

}  // namespace

Polygons read_vtp(const std::filesystem::path& file) {
  const std::string name = file.string(), bytes = read_file(file);
  VtkXml xml;
  parse_vtk_xml(name, bytes, "PolyData", xml);
  Polygons polygons;
  add_points(read_vtk_points(xml), polygons);
  add_cells(xml, name, "Polys", 7, polygons);
  add_cells(xml, name, "Strips", 6, polygons);
  return polygons;
}

Polygons read_vtk_surface(const std::filesystem::path& file) {
  const std::string name = file.string(), bytes = read_file(file);
  const bool is_xml = lower_case(file.extension().string()) == ".vtu";
  Polygons polygons = is_xml ? read_vtu_surface(name, bytes) : read_vtk_legacy_surface(name, bytes);
  if (polygons.corners.empty())
    throw InputError(name,
                     "has no triangle or polygon; if it is a mesh of tetrahedra, lobe takes it as it is");
  return polygons;
}

}  // namespace lobe
