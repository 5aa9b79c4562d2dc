// TetGen's pair of files: .node with the vertices, .ele with the tetrahedra. They count from 0 or 1.
#include "lobe/io/numeric.h"
#include "lobe/io/raw_mesh.h"

namespace lobe::io {
namespace {

// Returns the number of the first vertex, 0 or 1.
std::int64_t read_nodes(Scanner& scan, RawMesh& raw) {
  const std::size_t count = scan.count("vertices", 8);
  scan.integer("the dimension", 3, 3);
  const std::int64_t attributes = scan.integer("the number of attributes", 0, 1000);
  const std::int64_t markers = scan.integer("the number of boundary markers", 0, 1);
  raw.coordinates.reserve(3 * count);
  std::int64_t base = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t id = scan.integer("the number of a vertex");
    if (i == 0 && (id == 0 || id == 1)) base = id;
    if (id != base + static_cast<std::int64_t>(i))
      scan.fail("vertex number " + std::to_string(id) + ", expected " +
                std::to_string(base + static_cast<std::int64_t>(i)) +
                "; vertices are numbered one after the other from 0 or 1");
    for (int k = 0; k < 3; ++k) raw.coordinates.push_back(scan.real("a coordinate"));
    for (std::int64_t k = 0; k < attributes + markers; ++k) scan.word("an attribute or marker of a vertex");
  }
  return base;
}

void read_elements(Scanner& scan, std::int64_t base, RawMesh& raw) {
  const auto vertices = static_cast<std::int64_t>(raw.coordinates.size() / 3);
  const std::size_t count = scan.count("tetrahedra", 10);
  const std::int64_t nodes = scan.integer("the number of vertices of a tetrahedron");
  if (nodes != 4 && nodes != 10)
    scan.fail("tetrahedra of " + std::to_string(nodes) + " vertices, expected 4 or 10");
  const std::int64_t attributes = scan.integer("the number of attributes", 0, 1000);
  raw.corners.reserve(4 * count);
  std::vector<Index> corners(static_cast<std::size_t>(nodes));
  for (std::size_t i = 0; i < count; ++i) {
    scan.integer("the number of a tetrahedron");
    for (Index& v : corners)
      v = static_cast<Index>(scan.integer("a vertex of a tetrahedron", base, base + vertices - 1) - base);
    nodes == 4 ? (void)raw.corners.insert(raw.corners.end(), corners.begin(), corners.end())
               : add_ten_node(corners, raw);
    for (std::int64_t k = 0; k < attributes; ++k) {
      const auto region = whole_number(scan.real("a region"), -max_index, max_index);
      if (k > 0) continue;
      if (!region) scan.fail("the region of a tetrahedron must be a whole number below 2^31");
      raw.labels.push_back(static_cast<int>(*region));
    }
  }
}

}  // namespace

RawMesh read_tetgen(const std::string& node_name, std::string_view node, const std::string& ele_name,
                    std::string_view ele) {
  RawMesh raw;
  Scanner node_scan(node_name, node, '#'), ele_scan(ele_name, ele, '#');
  read_elements(ele_scan, read_nodes(node_scan, raw), raw);
  return raw;
}

}  // namespace lobe::io
