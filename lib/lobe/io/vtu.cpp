// VTK XML unstructured grids: the tetrahedra of one piece, and triangles in groups.
#include <charconv>

#include "lobe/error.h"
#include "lobe/io/vtk_cells.h"
#include "lobe/io/vtk_xml.h"

namespace lobe::io {
namespace {

VtkCells read_cells(const VtkXml& xml) {
  const pugi::xml_node node = vtk_child(xml, xml.piece, "Cells");
  VtkCells cells;
  cells.connectivity = read_vtk_array(xml, node, "connectivity");
  cells.ends = read_vtk_array(xml, node, "offsets");
  cells.types = read_vtk_array(xml, node, "types");
  check_vtk_count(xml, "NumberOfCells", cells.types.size());
  return cells;
}

std::vector<CellArray> single_values(const VtkXml& xml, const VtkData& cell_data) {
  std::vector<CellArray> arrays;
  for (const auto& [name, values] : cell_data) {
    if (values.rows() != 1) continue;
    const pugi::xml_node node =
        xml.piece.child("CellData").find_child_by_attribute("DataArray", "Name", name.c_str());
    const std::string_view type = node.attribute("type").value();
    arrays.push_back({name, {values.data(), values.data() + values.size()}, !type.starts_with("Float")});
  }
  return arrays;
}

// Three components per cell; not checked, since cells without fibres may have anything there.
void take_fibres(VtkData& cell_data, const std::vector<std::size_t>& tets, TetMesh& mesh) {
  const auto found = cell_data.find("fibre");
  if (found == cell_data.end() || found->second.rows() != 3) return;
  mesh.fibres = found->second(Eigen::all, tets);
  cell_data.erase(found);
}

// "11 held" and so on of an <Array> of strings in <FieldData>, by number. Strings end with 0. What is no
// number with a name is not lobe's, and left alone.
std::map<int, std::string> names_in_field_data(const VtkXml& xml, const char* array) {
  const pugi::xml_node node = xml.piece.parent().child("FieldData").find_child_by_attribute("Name", array);
  std::map<int, std::string> names;
  if (std::string_view(node.attribute("type").value()) != "String") return names;
  std::string text;
  for (const double code : read_data_array(xml.context, node)) {
    const auto byte = whole_number(code, -128, 255);
    if (byte.value_or(0) != 0) {
      text += static_cast<char>(*byte);
      continue;
    }
    int number = 0;
    const char* const last = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), last, number);
    if (error == std::errc() && rest + 1 < last && *rest == ' ') names[number] = {rest + 1, last};
    text.clear();
  }
  return names;
}

void take_names(const VtkXml& xml, RawMesh& raw) {
  raw.label_names = names_in_field_data(xml, vtu_label_names);
  for (auto& [number, name] : names_in_field_data(xml, vtu_surface_names))
    if (const auto group = raw.surfaces.find(number); group != raw.surfaces.end())
      group->second.name = std::move(name);
}

VtkData only_tetrahedra(const VtkData& cell_data, const std::vector<std::size_t>& tets) {
  VtkData data;
  for (const auto& [name, values] : cell_data) data[name] = values(Eigen::all, tets);
  return data;
}

}  // namespace

Polygons read_vtu_surface(const std::string& name, std::string_view bytes) {
  VtkXml xml;
  parse_vtk_xml(name, bytes, "UnstructuredGrid", xml);
  Polygons polygons;
  add_polygons(read_cells(xml), name, polygons);
  add_points(read_vtk_points(xml), polygons);
  return polygons;
}

MeshFile read_vtu(const std::string& name, std::string_view bytes, std::string_view labels) {
  VtkXml xml;
  parse_vtk_xml(name, bytes, "UnstructuredGrid", xml);
  RawMesh raw;
  raw.coordinates = read_vtk_points(xml);
  const VtkCells cells = read_cells(xml);
  const TakenCells taken_cells = take_cells(cells, name, raw);
  const std::vector<std::size_t>& tets = taken_cells.tets;
  VtkData point_data = read_vtk_data(xml, "PointData", raw.coordinates.size() / 3);
  VtkData cell_data = read_vtk_data(xml, "CellData", cells.types.size());
  const std::string taken = take_labels(single_values(xml, cell_data), cells, taken_cells, name, labels, raw);
  take_names(xml, raw);
  if (taken == "label" || !labels.empty()) cell_data.erase("label");
  std::vector<Index> kept;
  MeshFile file = finish(std::move(raw), name, &kept);
  take_fibres(cell_data, tets, file.mesh);
  for (auto& [of, values] : point_data)
    if (!kept.empty()) values = values(Eigen::all, kept).eval();
  file.point_data = std::move(point_data);
  file.cell_data = only_tetrahedra(cell_data, tets);
  return file;
}

}  // namespace lobe::io
