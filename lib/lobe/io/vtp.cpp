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

Polygons read_vtp(const std::filesystem::path& file) {
  const std::string name = file.string(), bytes = read_file(file);
  VtkXml xml;
  parse_vtk_xml(name, bytes, "PolyData", xml);
  const std::vector<double> x = read_vtk_points(xml);
  Polygons polygons;
  for (std::size_t i = 0; i < x.size(); i += 3) polygons.points.emplace_back(x[i], x[i + 1], x[i + 2]);
  const pugi::xml_node polys = vtk_child(xml, xml.piece, "Polys");
  const std::vector<double> corners = read_vtk_array(xml, polys, "connectivity"),
                            ends = read_vtk_array(xml, polys, "offsets");
  check_vtk_count(xml, "NumberOfPolys", ends.size());
  std::int64_t begin = 0;
  for (std::size_t cell = 0; cell < ends.size(); ++cell) {
    const std::string place = name + ": polygon " + std::to_string(cell);
    const auto end = whole_number(ends[cell], begin, static_cast<std::int64_t>(corners.size()));
    if (!end) throw InputError(place, "its offset is not between the one before and the end");
    auto& polygon = polygons.corners.emplace_back();
    for (; begin < *end; ++begin) {
      const auto vertex = whole_number(corners[static_cast<std::size_t>(begin)], 0, max_index);
      if (!vertex) throw InputError(place, "names a vertex that is not a whole number from 0");
      polygon.push_back(*vertex);
    }
  }
  if (const pugi::xml_node strips = xml.piece.child("Strips")) {
    VtkCells cells{read_vtk_array(xml, strips, "connectivity"), read_vtk_array(xml, strips, "offsets"), {}};
    cells.types.assign(cells.ends.size(), 6);
    add_polygons(cells, name, polygons);
  }
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
