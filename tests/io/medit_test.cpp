#include "io/fixture.h"
#include "lobe/io/raw_mesh.h"

using namespace lobe;

namespace {

MeshFile read_medit(const std::string& text) { return io::finish(io::read_medit("m.mesh", text), "m.mesh"); }
std::string fault_in_medit(const std::string& text) {
  return fixture::fault_of([&] { read_medit(text); });
}

const std::string medit_head = "MeshVersionFormatted 2\nDimension\n3\n";
const std::string vertices = "Vertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";

}  // namespace

TEST_CASE("MEDIT: comments and sections of no interest are skipped") {
  const MeshFile file = read_medit("# by hand\n" + medit_head + vertices +
                                   "Corners 2\n1 2\nNormals 1\n0 0 1e0\nTriangles 1\n1 2 3 4\n"
                                   "Tetrahedra # one\n1\n1 2 3 4 -5\nEnd\nwhatever");
  CHECK(file.mesh.tet_count() == 1);
  CHECK(file.mesh.labels == std::vector<int>{-5});
  CHECK(file.ignored_cells == 0);
  REQUIRE(file.surfaces.size() == 1);
  CHECK(file.surfaces[0].number == 4);
  CHECK(file.surfaces[0].triangles == std::vector<std::array<Index, 3>>{{0, 1, 2}});
}

TEST_CASE("MEDIT: of ten-node tetrahedra the corners are taken") {
  const std::string ten =
      "Vertices 10\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n.5 0 0 0\n.5 .5 0 0\n0 .5 0 0\n0 0 .5 0\n"
      ".5 0 .5 0\n0 .5 .5 0\n";
  const MeshFile file = read_medit(medit_head + ten + "TetrahedraP2 1\n1 2 3 4 5 6 7 8 9 10 3\nEnd");
  CHECK(file.mesh.points.cols() == 4);
  CHECK(file.mesh.labels == std::vector<int>{3});
}

TEST_CASE("MEDIT: an inside-out tetrahedron is turned round") {
  CHECK(read_medit(medit_head + vertices + "Tetrahedra 1\n1 3 2 4 0\nEnd").prepared.reoriented == 1);
}

TEST_CASE("MEDIT: bad files are refused at their line") {
  CHECK_CONTAINS(fault_in_medit("solid x"), "m.mesh:1: 'solid', expected MeshVersionFormatted");
  CHECK_CONTAINS(fault_in_medit("MeshVersionFormatted 2 Dimension 2"), "the dimension is 2, expected 3 … 3");
  CHECK_CONTAINS(fault_in_medit(medit_head + vertices + "Tetrahedra 1\n1 2 3 5 0"),
                 "m.mesh:10: a vertex of a tetrahedron is 5, expected 1 … 4");
  CHECK_CONTAINS(fault_in_medit(medit_head + vertices + "Tetrahedra 1\n0 2 3 4 0"), "is 0, expected 1 … 4");
  CHECK_CONTAINS(fault_in_medit(medit_head + vertices + "Tetrahedra 1\n1 2 3 4 99999999999"),
                 "a reference is 99999999999");
  CHECK_CONTAINS(fault_in_medit(medit_head + "Tetrahedra 1\n1 2 3 4 0"), "Tetrahedra before Vertices");
  CHECK_CONTAINS(fault_in_medit(medit_head + vertices + "Tetrahedra 1\n1 2 3 4 0\n1 2"),
                 "expected a keyword or End");
  CHECK_CONTAINS(fault_in_medit(medit_head + "Vertices 1\n0 0 zero 0"), "'zero', expected a coordinate");
  CHECK_CONTAINS(fault_in_medit(medit_head + "Vertices 4000000\n0 0 0 0"), "4000000 vertices are announced");
  CHECK_CONTAINS(fault_in_medit(medit_head + vertices + "Triangles 1\n1 2 3 0\nEnd"),
                 "has no tetrahedron, only 1 triangle");
  CHECK_CONTAINS(fault_in_medit(medit_head + vertices + "End"), "has no tetrahedron");
  CHECK_CONTAINS(fault_in_medit(fixture::edited(medit_head + vertices, "1 0 0 0", "nan 0 0 0") +
                                "Tetrahedra 1\n1 2 3 4 0"),
                 "vertex 1");
  CHECK_CONTAINS(fault_in_medit(fixture::edited(medit_head + vertices, "0 0 1 0", "1 1 0 0") +
                                "Tetrahedra 1\n1 2 3 4 0"),
                 "is flat");
  CHECK_CONTAINS(fault_in_medit(medit_head + vertices + "Tetrahedra 2\n1 2 3 4 0\n1 2 3 4 0"),
                 "has the same vertices");
}

TEST_CASE("MEDIT: a vertex of no tetrahedron is kept") {
  const std::string five = fixture::edited(vertices, "Vertices 4\n", "Vertices 5\n9 9 9 0\n");
  const MeshFile file = read_medit(medit_head + five + "Tetrahedra 1\n2 3 4 5 0");
  CHECK(file.mesh.vertex_count() == 5);
  CHECK(file.prepared.unreferenced == 1);
}
