// MEDIT .mesh in ascii: keywords, each followed by a count and that many lines of numbers.
#include <map>

#include "lobe/io/raw_mesh.h"

namespace lobe::io {
namespace {

// Cells that are ignored: what one is called, and how many vertices it has. Its reference follows them.
struct OtherCell {
  const char* kind;
  int vertices;
};
const std::map<std::string, OtherCell> other_cells = {
    {"edges", {"line", 2}},           {"quadrilaterals", {"quadrangle", 4}},
    {"hexahedra", {"hexahedron", 8}}, {"hexaedra", {"hexahedron", 8}},
    {"prisms", {"wedge", 6}},         {"pentahedra", {"wedge", 6}},
    {"pyramids", {"pyramid", 5}}};

bool starts_keyword(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

void read_vertices(Scanner& scan, RawMesh& raw) {
  const std::size_t count = scan.count("vertices", 8);
  raw.coordinates.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) raw.coordinates.push_back(scan.real("a coordinate"));
    scan.word("the reference of a vertex");
  }
}

// Of four or ten nodes.
void read_tetrahedra(Scanner& scan, std::size_t nodes, RawMesh& raw) {
  const auto vertices = static_cast<std::int64_t>(raw.coordinates.size() / 3);
  if (vertices == 0) scan.fail("Tetrahedra before Vertices; the order must be the other way round");
  const std::size_t count = scan.count("tetrahedra", 2 * nodes + 2);
  raw.corners.reserve(raw.corners.size() + 4 * count);
  std::vector<Index> corners(nodes);
  for (std::size_t i = 0; i < count; ++i) {
    for (Index& v : corners)
      v = static_cast<Index>(scan.integer("a vertex of a tetrahedron", 1, vertices) - 1);
    nodes == 4 ? (void)raw.corners.insert(raw.corners.end(), corners.begin(), corners.end())
               : add_ten_node(corners, raw);
    raw.labels.push_back(static_cast<int>(scan.integer("a reference", -max_index, max_index)));
  }
}

// Their references, but 0, are groups.
void read_triangles(Scanner& scan, RawMesh& raw) {
  const auto vertices = static_cast<std::int64_t>(raw.coordinates.size() / 3);
  const std::size_t count = scan.count("triangles", 8);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<Index, 3> triangle;
    for (Index& v : triangle) v = static_cast<Index>(scan.integer("a vertex of a triangle", 1, vertices) - 1);
    const int group = static_cast<int>(scan.integer("a reference", -max_index, max_index));
    group == 0 ? (void)++raw.ignored["triangle"] : raw.surfaces[group].triangles.push_back(triangle);
  }
}

void skip_cells(Scanner& scan, const OtherCell& cell, RawMesh& raw) {
  const std::size_t count = scan.count("cells", 2 * static_cast<std::size_t>(cell.vertices + 1));
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k <= cell.vertices; ++k) scan.integer("a vertex or reference of a cell");
  if (count > 0) raw.ignored[cell.kind] += static_cast<Index>(count);
}

void read_medit_header(Scanner& scan) {
  scan.expect("MeshVersionFormatted");
  scan.integer("the version", 0, 4);
  scan.expect("Dimension");
  scan.integer("the dimension", 3, 3);
}

}  // namespace

RawMesh read_medit(const std::string& name, std::string_view bytes) {
  Scanner scan(name, bytes, '#');
  read_medit_header(scan);
  RawMesh raw;
  while (!scan.at_end()) {
    const std::string keyword = lower_case(scan.word("a keyword"));
    if (keyword == "end") break;
    if (keyword == "vertices")
      read_vertices(scan, raw);
    else if (keyword == "tetrahedra")
      read_tetrahedra(scan, 4, raw);
    else if (keyword == "tetrahedrap2")
      read_tetrahedra(scan, 10, raw);
    else if (keyword == "triangles")
      read_triangles(scan, raw);
    else if (const auto cells = other_cells.find(keyword); cells != other_cells.end())
      skip_cells(scan, cells->second, raw);
    else if (!starts_keyword(keyword.front()))
      scan.fail("'" + keyword.substr(0, 40) + "', expected a keyword or End; a count does not agree");
    else  // corners, ridges, normals …: numbers that a mesh at rest does not need
      while (!scan.at_end() && !starts_keyword(scan.peek())) scan.word("a number");
  }
  return raw;
}

}  // namespace lobe::io
