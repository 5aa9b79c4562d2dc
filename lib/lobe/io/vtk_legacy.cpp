// Legacy VTK files (VTK user's guide, "Simple legacy formats"), versions 2.0 to 5.1. Binary parts are
// big-endian and begin after the line that announces them.
#include "lobe/io/vtk_legacy.h"

namespace lobe::io {
namespace {

struct LegacyMesh {
  RawMesh raw;
  VtkCells cells;
  bool has_cells = false;
};

struct LegacyHeader {
  int version = 0;  // the major one
  std::string dataset;
};

LegacyHeader read_legacy_header(Scanner& scan) {
  constexpr std::string_view magic = "# vtk DataFile Version ";
  const std::string first(scan.line());
  if (first.substr(0, magic.size()) != magic)
    scan.fail("expected '# vtk DataFile Version …'; is this a legacy VTK file?");
  const char major = first.size() > magic.size() ? first[magic.size()] : '\0';
  if (major < '1' || major > '5') scan.fail("unknown version, expected 2.0 … 5.1");
  scan.line();  // the title
  const std::string encoding = lower_case(scan.word("ASCII or BINARY"));
  if (encoding != "ascii" && encoding != "binary") scan.fail("expected ASCII or BINARY");
  if (encoding == "binary") scan.set_binary(std::endian::native == std::endian::little);
  scan.expect("DATASET");
  return {major - '0', lower_case(scan.word("a data set"))};
}

void read_points(Scanner& scan, RawMesh& raw) {
  const std::size_t count = scan.count("points", 3);
  const std::string type = lower_case(scan.word("the type of the points"));
  raw.coordinates = read_legacy_array(scan, type, 3 * count, "points");
  skip_legacy_metadata(scan, 3);
}

// Up to version 4.2: for each cell the number of its vertices, and the vertices.
void read_cells_4(Scanner& scan, VtkCells& cells) {
  const std::size_t count = scan.count("cells", 1), size = scan.count("numbers", 1);
  const std::vector<double> numbers = read_legacy_array(scan, "int", size, "cells");
  std::size_t at = 0;
  for (std::size_t cell = 0; cell < count; ++cell) {
    const auto left = static_cast<std::int64_t>(size - at) - 1;
    const auto vertices = left < 0 ? std::nullopt : whole_number(numbers[at], 0, left);
    if (!vertices)
      scan.fail("the vertices of cell " + std::to_string(cell) + " go beyond the " + std::to_string(size) +
                " numbers of CELLS");
    for (std::int64_t k = 0; k < *vertices; ++k) cells.connectivity.push_back(numbers[++at]);
    ++at;
    cells.ends.push_back(static_cast<double>(cells.connectivity.size()));
  }
}

std::vector<double> read_named_array(Scanner& scan, const char* keyword, std::size_t count) {
  scan.expect(keyword);
  const std::string type = lower_case(scan.word("a type"));
  return read_legacy_array(scan, type, count, keyword);
}

// From version 5: OFFSETS, one more than cells, and CONNECTIVITY.
void read_cells_5(Scanner& scan, VtkCells& cells) {
  const std::size_t offsets = scan.count("offsets", 1), size = scan.count("numbers", 1);
  cells.ends = read_named_array(scan, "OFFSETS", offsets);
  if (!cells.ends.empty()) cells.ends.erase(cells.ends.begin());  // always 0
  cells.connectivity = read_named_array(scan, "CONNECTIVITY", size);
}

void read_connectivity(Scanner& scan, int version, VtkCells& cells) {
  version >= 5 ? read_cells_5(scan, cells) : read_cells_4(scan, cells);
}

void read_block(Scanner& scan, const std::string& keyword, int version, LegacyMesh& mesh) {
  if (keyword == "points") {
    read_points(scan, mesh.raw);
  } else if (keyword == "cells") {
    read_connectivity(scan, version, mesh.cells);
    mesh.has_cells = true;
  } else if (keyword == "cell_types") {
    const std::size_t count = scan.count("cell types", 1);
    mesh.cells.types = read_legacy_array(scan, "int", count, "cell types");
  } else if (keyword == "field") {
    read_legacy_field(scan, nullptr);
  } else {
    scan.fail("unknown keyword, expected POINTS, CELLS, CELL_TYPES, POINT_DATA or CELL_DATA");
  }
}

}  // namespace

std::vector<double> read_legacy_array(Scanner& scan, std::string_view type, std::size_t count,
                                      const std::string& what) {
  if (type == "bit" && scan.is_binary()) {  // eight to a byte
    scan.line();
    scan.bytes(count / 8 + (count % 8 != 0), what);
    return std::vector<double>(count, 0.0);
  }
  const auto number = type == "bit" ? Number::u8 : legacy_number(type);
  if (!number)
    scan.fail("type '" + std::string(type.substr(0, 40)) + "' of " + what +
              ", expected float, double, int …");
  if (scan.is_binary()) {
    scan.line();
    const std::size_t size = size_of(*number);
    scan.require_room(count, size, what);
    return decode(*number, scan.bytes(count * size, what), scan.swaps());
  }
  scan.require_room(count, 2, what);
  std::vector<double> values(count);
  for (double& value : values) value = scan.real("a value of " + what);
  return values;
}

RawMesh read_vtk_legacy(const std::string& name, std::string_view bytes, std::string_view labels) {
  Scanner scan(name, bytes);
  const auto [version, dataset] = read_legacy_header(scan);
  if (dataset != "unstructured_grid")
    scan.fail("expected DATASET UNSTRUCTURED_GRID; a surface is meshed by lobe-mesh");
  LegacyMesh mesh;
  LegacyArrays arrays;
  while (!scan.at_end()) {
    const std::string keyword = lower_case(scan.word("a keyword"));
    if (keyword == "point_data" || keyword == "cell_data")
      arrays = read_legacy_attributes(scan, keyword, mesh.raw.coordinates.size() / 3, mesh.cells.ends.size());
    else
      read_block(scan, keyword, version, mesh);
  }
  if (!mesh.has_cells) scan.fail("the file has no CELLS; it is truncated");
  const TakenCells taken = take_cells(mesh.cells, name, mesh.raw);
  take_labels(arrays, mesh.cells, taken, name, labels, mesh.raw);
  return std::move(mesh.raw);
}

namespace {

// A block of POLYDATA. Cells of the two kinds that are surfaces go to `polygons`.
void read_surface_block(Scanner& scan, const std::string& keyword, int version, const std::string& name,
                        RawMesh& raw, Polygons& polygons) {
  const double type = keyword == "polygons" ? 7 : keyword == "triangle_strips" ? 6 : 0;
  if (keyword == "points") return read_points(scan, raw);
  if (keyword == "field") return read_legacy_field(scan, nullptr);
  if (type == 0 && keyword != "lines" && keyword != "vertices")
    scan.fail("unknown keyword, expected POINTS, POLYGONS, TRIANGLE_STRIPS, LINES or VERTICES");
  VtkCells cells;
  read_connectivity(scan, version, cells);
  cells.types.assign(cells.ends.size(), type);
  add_polygons(cells, name, polygons);
}

}  // namespace

Polygons read_vtk_legacy_surface(const std::string& name, std::string_view bytes) {
  Scanner scan(name, bytes);
  const auto [version, dataset] = read_legacy_header(scan);
  const bool is_grid = dataset == "unstructured_grid";
  if (!is_grid && dataset != "polydata") scan.fail("expected DATASET POLYDATA or UNSTRUCTURED_GRID");
  LegacyMesh mesh;
  Polygons polygons;
  while (!scan.at_end()) {
    const std::string keyword = lower_case(scan.word("a keyword"));
    if (keyword == "point_data" || keyword == "cell_data") break;
    is_grid ? read_block(scan, keyword, version, mesh)
            : read_surface_block(scan, keyword, version, name, mesh.raw, polygons);
  }
  if (is_grid) add_polygons(mesh.cells, name, polygons);
  add_points(mesh.raw.coordinates, polygons);
  return polygons;
}

}  // namespace lobe::io
