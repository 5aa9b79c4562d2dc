// MEDIT .mesh in ascii: keywords, each followed by a count and that many lines of numbers.
#include <map>

#include "lobe/io/raw_mesh.h"

namespace lobe::io {
namespace {

// Cells that are ignored: how many vertices each has. Its reference follows them.
const std::map<std::string, int> other_cells = {{"edges", 2},     {"triangles", 3}, {"quadrilaterals", 4},
                                                {"hexahedra", 8}, {"prisms", 6},    {"pentahedra", 6},
                                                {"pyramids", 5},  {"hexaedra", 8}};

bool starts_keyword(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

void read_vertices(Scanner& scan, RawMesh& raw) {
  const std::size_t count = scan.count("vertices", 8);
  raw.coordinates.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) raw.coordinates.push_back(scan.real("a coordinate"));
    scan.word("the reference of a vertex");
  }
}

void read_tetrahedra(Scanner& scan, RawMesh& raw) {
  const auto vertices = static_cast<std::int64_t>(raw.coordinates.size() / 3);
  if (vertices == 0) scan.fail("Tetrahedra before Vertices; the order must be the other way round");
  const std::size_t count = scan.count("tetrahedra", 10);
  raw.corners.reserve(4 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 4; ++k)
      raw.corners.push_back(static_cast<Index>(scan.integer("a vertex of a tetrahedron", 1, vertices) - 1));
    raw.labels.push_back(static_cast<int>(scan.integer("a reference", -max_index, max_index)));
  }
}

void skip_cells(Scanner& scan, int vertices, RawMesh& raw) {
  const std::size_t count = scan.count("cells", 2 * static_cast<std::size_t>(vertices + 1));
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k <= vertices; ++k) scan.integer("a vertex or reference of a cell");
  raw.ignored_cells += static_cast<Index>(count);
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
      read_tetrahedra(scan, raw);
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
