#include "lobe/mesh/joined_mesh.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/refine.h"

using namespace lobe;

namespace {

TetMesh box_of(int label, int cells) {
  TetMesh box = box_mesh({1, 1, 1}, cells, 1, 1);
  box.labels.assign(std::size_t(box.tet_count()), label);
  return box;
}

TetMesh three_boxes() {
  TetMesh mesh;
  append_body(box_of(3, 1), "a", mesh);
  append_body(box_of(3, 2), "b", mesh);
  append_body(box_of(5, 3), "c", mesh);
  return mesh;
}

}  // namespace

TEST_CASE("bodies are numbered one after the other, and keep their labels") {
  const TetMesh mesh = three_boxes();
  CHECK(mesh.bodies.names == std::vector<std::string>{"a", "b", "c"});
  REQUIRE(mesh.tet_count() == 36);
  REQUIRE(mesh.vertex_count() == 8 + 12 + 16);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const int body = t < 6 ? 0 : t < 18 ? 1 : 2;
    CHECK(mesh.bodies.body_of(t) == body);
    CHECK(mesh.labels[std::size_t(t)] == (body == 2 ? 5 : 3));
    const Index first = body == 0 ? 0 : body == 1 ? 8 : 20, end = body == 0 ? 8 : body == 1 ? 20 : 36;
    CHECK((mesh.tets.col(t).minCoeff() >= first && mesh.tets.col(t).maxCoeff() < end));
  }
  CHECK(mesh.bodies.in_words(20) == " of \"c\"");
  CHECK(box_of(0, 1).bodies.in_words(0).empty());
}

TEST_CASE("each body comes back as it was added") {
  const TetMesh mesh = three_boxes();
  for (int body = 0; body < 3; ++body) {
    const TetMesh given = box_of(body == 2 ? 5 : 3, body + 1), back = mesh_of_body(mesh, body);
    CHECK(back.points == given.points);
    CHECK(back.tets == given.tets);
    CHECK(back.labels == given.labels);
    CHECK_FALSE(back.bodies.any());
  }
}

TEST_CASE("vertices of no tetrahedron keep the numbers of all others when bodies are joined again") {
  TetMesh loose = box_of(0, 1);
  loose.points.conservativeResize(3, 10);
  loose.points.rightCols(2).setConstant(7);
  TetMesh mesh, again;
  append_body(loose, "a", mesh);
  append_body(box_of(0, 2), "b", mesh);
  for (int body = 0; body < 2; ++body)
    append_body(mesh_of_body(mesh, body), mesh.bodies.names[std::size_t(body)], again);
  CHECK(again.points == mesh.points);
  CHECK(again.tets == mesh.tets);
}

TEST_CASE("fibres of one body are zero in the others") {
  TetMesh fibrous = box_of(0, 1), mesh;
  fibrous.fibres = Mat3X<double>::Constant(3, 6, 0.5);
  append_body(box_of(0, 1), "a", mesh);
  CHECK(mesh.fibres.cols() == 0);
  append_body(fibrous, "b", mesh);
  append_body(box_of(0, 1), "c", mesh);
  REQUIRE(mesh.fibres.cols() == 18);
  CHECK(mesh.fibres.leftCols(6).isZero(0));
  CHECK(mesh.fibres.middleCols(6, 6) == fibrous.fibres);
  CHECK(mesh.fibres.rightCols(6).isZero(0));
}

TEST_CASE("tetrahedra of a refined mesh stay in their bodies") {
  const TetMesh fine = refine(three_boxes()).mesh;
  CHECK(fine.bodies.names.size() == 3);
  for (Index t = 0; t < fine.tet_count(); ++t)
    CHECK(fine.bodies.body_of(t) == (t < 48 ? 0 : t < 144 ? 1 : 2));
}

TEST_CASE("too many bodies, and bodies whose vertices are mixed, are refused") {
  TetMesh mesh;
  for (int i = 0; i < 255; ++i) append_body(box_of(0, 1), std::to_string(i), mesh);
  CHECK_THROWS_WITH_AS(append_body(box_of(0, 1), "last", mesh),
                       "last: is one body too many: a mesh has at most 255", InputError);
  TetMesh mixed = three_boxes();
  std::swap(mixed.bodies.of.front(), mixed.bodies.of.back());
  CHECK_THROWS_WITH_AS(mesh_of_body(mixed, 1), "mesh: its vertices are not numbered body by body",
                       InputError);
}
