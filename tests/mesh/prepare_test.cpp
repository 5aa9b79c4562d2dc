#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/tet_mesh.h"

using namespace lobe;

namespace {

std::string fault_of(TetMesh mesh) {
  try {
    prepare(mesh, "cube");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no fault";
}

TetMesh cube() { return box_mesh({1, 1, 1}, 1, 1, 1); }

void append(TetMesh& mesh, Eigen::Matrix<Index, 4, 1> corners) {
  mesh.tets.conservativeResize(4, mesh.tets.cols() + 1);
  mesh.tets.rightCols<1>() = corners;
  mesh.labels.push_back(0);
}

#define CHECK_CONTAINS(text, part)         \
  do {                                     \
    const std::string found = (text);      \
    CAPTURE(found);                        \
    CHECK(found.find(part) != found.npos); \
  } while (false)

}  // namespace

TEST_CASE("a good mesh is left alone and its missing labels become 0") {
  TetMesh mesh = cube();
  const TetMesh before = mesh;
  mesh.labels.clear();
  const PrepareReport report = prepare(mesh, "cube");
  CHECK(report.warnings().empty());
  CHECK(mesh.tets == before.tets);
  CHECK(mesh.labels == std::vector<int>(6, 0));
}

TEST_CASE("inside-out tetrahedra are turned round and counted") {
  TetMesh mesh = cube();
  std::swap(mesh.tets(0, 1), mesh.tets(1, 1));
  std::swap(mesh.tets(0, 4), mesh.tets(3, 4));
  const PrepareReport report = prepare(mesh, "cube");
  CHECK(report.reoriented == 2);
  CHECK(report.warnings() == std::vector<std::string>{"2 tetrahedra were inside out and turned round"});
  for (Index t = 0; t < mesh.tet_count(); ++t) CHECK(signed_volume(tet_points(mesh, t)) > 0);
}

TEST_CASE("vertices of no tetrahedron are kept and counted") {
  TetMesh mesh = cube();
  mesh.points.conservativeResize(3, 9);
  mesh.points.col(8) = Vec3d(5, 5, 5);
  const PrepareReport report = prepare(mesh, "cube");
  CHECK(report.unreferenced == 1);
  CHECK(report.warnings() ==
        std::vector<std::string>{"1 vertex belongs to no tetrahedron and stays at rest"});
  CHECK(mesh.vertex_count() == 9);
}

TEST_CASE("bad meshes are refused by name, with offender and remedy") {
  CHECK_CONTAINS(fault_of(TetMesh()), "cube: has no tetrahedron");
  TetMesh mesh = cube();
  mesh.tets(2, 3) = 8;
  CHECK_CONTAINS(fault_of(mesh), "cube: tetrahedron 3: its vertices are");
  CHECK_CONTAINS(fault_of(mesh), "expected 0 … 7");
  mesh = cube();
  mesh.tets(0, 0) = -1;
  CHECK_CONTAINS(fault_of(mesh), "cube: tetrahedron 0: its vertices are -1");
  mesh = cube();
  mesh.tets(0, 5) = mesh.tets(1, 5);
  CHECK_CONTAINS(fault_of(mesh), "cube: tetrahedron 5: uses a vertex twice");
  mesh = cube();
  mesh.points(1, 6) = std::numeric_limits<double>::quiet_NaN();
  CHECK_CONTAINS(fault_of(mesh), "cube: vertex 6: its position is (0, nan, 1)");
  mesh.points(1, 6) = std::numeric_limits<double>::infinity();
  CHECK_CONTAINS(fault_of(mesh), "cube: vertex 6: its position is (0, inf, 1)");
  mesh = cube();
  mesh.labels.pop_back();
  CHECK_CONTAINS(fault_of(mesh), "5 labels for 6 tetrahedra");
  mesh = cube();
  mesh.fibres = Vec3d(1, 0, 0).replicate(1, 7);
  CHECK_CONTAINS(fault_of(mesh), "7 fibre directions for 6 tetrahedra");
}

TEST_CASE("flat tetrahedra are refused and counted") {
  TetMesh mesh = cube();
  append(mesh, {0, 1, 2, 3});  // the bottom of the cube
  append(mesh, {4, 5, 6, 7});
  const std::string text = fault_of(mesh);
  CHECK_CONTAINS(text, "cube: tetrahedron 6: is flat: its smallest altitude is 0 m");
  CHECK_CONTAINS(text, "(2 such: 6, 7)");
}

TEST_CASE("a tetrahedron is flat below 1e-7 of its longest edge, whatever the unit of length") {
  for (const double unit : {1e-40, 1e-3, 1.0, 1e40}) {
    TetMesh mesh;
    mesh.points.resize(3, 4);
    mesh.points << 0, 1, 0, 0, /**/ 0, 0, 1, 0, /**/ 0, 0, 0, 2e-7;  // longest edge √2
    mesh.points *= unit;
    mesh.tets.resize(4, 1);
    mesh.tets << 0, 1, 2, 3;
    CHECK(fault_of(mesh) == "no fault");
    mesh.points(2, 3) = 1e-7 * unit;
    CHECK_CONTAINS(fault_of(mesh), "is flat");
  }
}

TEST_CASE("coordinates so large or so small that volumes leave double precision are refused") {
  TetMesh mesh = cube();
  mesh.points *= 1e60;
  CHECK_CONTAINS(fault_of(mesh), "expected finite numbers below 1e+50");
  mesh = cube();
  mesh.points *= 1e-60;
  CHECK_CONTAINS(fault_of(mesh), "is flat");
}

TEST_CASE("the bounding box leaves out vertices that no tetrahedron uses") {
  TetMesh mesh = cube();
  const Box before = bounding_box(mesh);
  mesh.points.conservativeResize(3, mesh.points.cols() + 1);
  mesh.points.rightCols<1>().setConstant(9);
  CHECK(bounding_box(mesh).max == before.max);
  CHECK(bounding_box(mesh).min == before.min);
}

TEST_CASE("a tetrahedron that comes twice is refused") {
  TetMesh mesh = cube();
  append(mesh, mesh.tets.col(2));
  CHECK_CONTAINS(fault_of(mesh), "cube: tetrahedron 6: has the same vertices as tetrahedron 2");
}

TEST_CASE("a face of three tetrahedra is refused") {
  TetMesh mesh = cube();
  mesh.points.conservativeResize(3, 9);
  mesh.points.col(8) = Vec3d(0.3, 0.9, 0.4);
  const Eigen::Matrix<Index, 4, 1> c = mesh.tets.col(0);
  append(mesh, {c[0], c[1], 8, c[3]});  // on a diagonal face, which two tetrahedra share already
  CHECK_CONTAINS(fault_of(mesh), "is shared by 3 tetrahedra");
}

TEST_CASE("all kinds of faults are told at once, and of each the first five") {
  TetMesh mesh = cube();
  mesh.points(0, 2) = std::numeric_limits<double>::quiet_NaN();
  mesh.tets.row(1).setConstant(77);
  const std::string text = fault_of(mesh);
  CHECK_CONTAINS(text, "vertex 2");
  CHECK_CONTAINS(text, "(6 such: 0, 1, 2, 3, 4, …)");
}
