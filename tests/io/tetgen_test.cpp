#include "io/fixture.h"
#include "lobe/io/mesh_io.h"
#include "lobe/io/raw_mesh.h"

using namespace lobe;

namespace {

const std::string nodes =
    "# comment\n4 3 1 1\n1 0 0 0 0.5 0\n2 1 0 0 0.5 0\n3 0 1 0 0.5 1\n4 0 0 1 0.5 1 # last\n";

MeshFile read_tetgen(const std::string& node, const std::string& ele) {
  return io::finish(io::read_tetgen("t.node", node, "t.ele", ele), "t.ele");
}
std::string fault_in_tetgen(const std::string& node, const std::string& ele) {
  return fixture::fault_of([&] { read_tetgen(node, ele); });
}

}  // namespace

TEST_CASE("TetGen: numbers from 1, attributes, markers and comments") {
  const MeshFile file = read_tetgen(nodes, "1 4 1\n# x\n1 1 2 3 4 3.0\n");
  CHECK(file.mesh.points.col(3) == Vec3d(0, 0, 1));
  CHECK(file.mesh.labels == std::vector<int>{3});
}

TEST_CASE("TetGen: either name of the pair finds the other") {
  CHECK(read_mesh(fixture::data / "tetgen.node").mesh.tets ==
        read_mesh(fixture::data / "tetgen.ele").mesh.tets);
}

TEST_CASE("TetGen: of ten-node tetrahedra the corners are taken") {
  const std::string ten =
      "10 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 0 .5 .5\n5 0 0 .5\n6 0 .5 0\n7 .5 .5 0\n"
      "8 .5 0 .5\n9 .5 0 0\n";
  const MeshFile file = read_tetgen(ten, "1 10 1\n0 0 1 2 3 4 5 6 7 8 9 8\n");
  CHECK(file.mesh.points.cols() == 4);
  CHECK(file.mesh.labels == std::vector<int>{8});
}

TEST_CASE("TetGen: tetrahedra without a region have label 0") {
  CHECK(read_tetgen(nodes, "1 4 0\n1 1 2 3 4").mesh.labels == std::vector<int>{0});
}

TEST_CASE("TetGen: bad files are refused at their line") {
  CHECK_CONTAINS(fault_in_tetgen(nodes, "1 4 0\n1 0 2 3 4"),
                 "t.ele:2: a vertex of a tetrahedron is 0, expected 1 … 4");
  CHECK_CONTAINS(fault_in_tetgen(nodes, "1 4 0\n1 1 2 3 5"), "is 5, expected 1 … 4");
  CHECK_CONTAINS(fault_in_tetgen(nodes, "1 5 0\n1 1 2 3 4 5"), "tetrahedra of 5 vertices, expected 4 or 10");
  CHECK_CONTAINS(fault_in_tetgen(nodes, "1 10 0\n1 1 2 3 4 5 6 7 8 9 10"), "is 5, expected 1 … 4");
  CHECK_CONTAINS(fault_in_tetgen(nodes, "1 4 1\n1 1 2 3 4 1.5"),
                 "the region of a tetrahedron must be a whole number");
  CHECK_CONTAINS(fault_in_tetgen(nodes, "100 4 0\n1 1 2 3 4"), "100 tetrahedra are announced");
  CHECK_CONTAINS(fault_in_tetgen(nodes, "0 4 0\n"), "has no tetrahedron");
  CHECK_CONTAINS(fault_in_tetgen("0 2 0 0\n", "1 4 0\n"), "t.node:1: the dimension is 2");
  CHECK_CONTAINS(fault_in_tetgen(fixture::edited(nodes, "3 0 1 0", "7 0 1 0"), ""),
                 "t.node:5: vertex number 7, expected 3");
  CHECK_CONTAINS(fault_in_tetgen(fixture::edited(nodes, "3 0 1 0", "3 0 nan 0"), "1 4 0\n1 1 2 3 4"),
                 "vertex 2");
}
