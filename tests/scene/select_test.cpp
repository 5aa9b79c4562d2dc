// Counts on a box of cells that are each split into six tetrahedra (Kuhn): 4 × 2 × 2 cells of edge 1.
#include "lobe/scene/select.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"

using namespace lobe;

namespace {

const TetMesh mesh = [] {
  TetMesh box = box_mesh({4, 2, 2}, 4, 2, 2);
  for (Index t = 0; t < box.tet_count(); ++t) box.labels[static_cast<std::size_t>(t)] = t < 12 ? 1 : 0;
  return box;
}();

Selector plane(const Vec3d& point, const Vec3d& normal, SelectPlane::Side side, double within = 0) {
  return {SelectPlane{point, normal, side, within}};
}
Selector negation(const Selector& part) { return {SelectNot{{part}}}; }

std::size_t vertices(const Selector& selector) { return select_vertices(selector, mesh).size(); }
std::size_t tets(const Selector& selector) { return select_tets(selector, mesh).size(); }
std::size_t faces(const Selector& selector) { return select_faces(selector, mesh, outer_faces(mesh)).size(); }

using Side = SelectPlane::Side;
const Selector everything = {SelectAll{}};

}  // namespace

TEST_CASE("the outer faces of a box are two triangles per square") {
  CHECK(outer_faces(mesh).size() == 2 * (2 * 2 * 2 + 4 * (4 * 2)));
  for (const TetFace& face : outer_faces(mesh)) {
    Vec3d centre = Vec3d::Zero();
    for (const int corner : face_corners[face.face])
      centre += mesh.points.col(mesh.tets(corner, face.tet)) / 3;
    const bool outside =
        centre.minCoeff() < 1e-12 || centre[0] > 4 - 1e-12 || centre.tail<2>().maxCoeff() > 2 - 1e-12;
    CHECK(outside);
  }
}

TEST_CASE("all selects everything, not all nothing") {
  CHECK(vertices(everything) == 45);
  CHECK(tets(everything) == 96);
  CHECK(faces(everything) == 80);
  CHECK(vertices(negation(everything)) == 0);
  CHECK(tets(negation(everything)) == 0);
  CHECK(faces(negation(everything)) == 0);
}

TEST_CASE("a box takes vertices on its faces, and tetrahedra by barycentre") {
  const Selector first_cells = {SelectBox{{0, 0, 0}, {1, 2, 2}}};
  CHECK(vertices(first_cells) == 18);
  CHECK(tets(first_cells) == 24);
  CHECK(faces(first_cells) == 8 + 4 * 4);
  CHECK(vertices({SelectBox{{0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}}}) == 0);
}

TEST_CASE("a sphere takes what is within its radius, its surface included") {
  CHECK(vertices({SelectSphere{{0, 0, 0}, 1}}) == 4);
  CHECK(vertices({SelectSphere{{0, 0, 0}, 0.999}}) == 1);
  CHECK(vertices({SelectSphere{{2, 1, 1}, 1}}) == 7);
  CHECK(tets({SelectSphere{{2, 1, 1}, 10}}) == 96);
}

TEST_CASE("a plane takes a distance or a side, its length of normal apart") {
  CHECK(vertices(plane({4, 0, 0}, {1, 0, 0}, Side::within, 1e-9)) == 9);
  CHECK(faces(plane({4, 0, 0}, {1, 0, 0}, Side::within, 1e-9)) == 8);
  CHECK(vertices(plane({4, 0, 0}, {5, 0, 0}, Side::within, 1)) == 18);
  CHECK(vertices(plane({1, 0, 0}, {-3, 0, 0}, Side::above)) == 18);
  CHECK(vertices(plane({1, 0, 0}, {-3, 0, 0}, Side::below)) == 36);
  CHECK(tets(plane({1, 0, 0}, {1, 0, 0}, Side::below)) == 24);
  CHECK(tets(plane({1, 0, 0}, {1, 0, 0}, Side::above)) == 72);
}

TEST_CASE("nearest takes exactly as many as asked, and all if there are fewer") {
  CHECK(select_vertices({SelectNearest{{0.1, 0, 0}, 2}}, mesh) == std::vector<Index>{0, 1});
  CHECK(tets({SelectNearest{{0, 0, 0}, 7}}) == 7);
  CHECK(vertices({SelectNearest{{0, 0, 0}, 1000}}) == 45);
}

TEST_CASE("labels, vertices and tetrahedra select each other") {
  CHECK(tets({SelectLabel{{1}}}) == 12);
  CHECK(tets({SelectLabel{{0, 1}}}) == 96);
  CHECK(tets({SelectLabel{{7}}}) == 0);
  CHECK(vertices({SelectLabel{{1}}}) == 12);  // of the cells (0,0,0) and (1,0,0)
  CHECK(select_tets({SelectTetrahedra{{95, 3, 3}}}, mesh) == std::vector<Index>{3, 95});
  CHECK(vertices({SelectTetrahedra{{3}}}) == 4);
  CHECK(select_vertices({SelectVertices{{7, 2}}}, mesh) == std::vector<Index>{2, 7});
  const std::vector<Index> corners(mesh.tets.col(5).begin(), mesh.tets.col(5).end());
  CHECK(select_tets({SelectVertices{corners}}, mesh) == std::vector<Index>{5});
}

TEST_CASE("any_of, all_of and not are union, intersection and complement") {
  const Selector left = {SelectBox{{0, 0, 0}, {1, 2, 2}}}, label = {SelectLabel{{1}}};
  CHECK(tets({SelectAnyOf{{left, label}}}) == 30);
  CHECK(tets({SelectAllOf{{left, label}}}) == 6);
  CHECK(tets({SelectAllOf{{left, negation(label)}}}) == 18);
  CHECK(tets(negation({SelectAnyOf{{left, label}}})) == 66);
}

TEST_CASE("a vertex of no tetrahedron is never selected") {
  TetMesh loose = mesh;
  loose.points.conservativeResize(3, 46);
  loose.points.col(45) = Vec3d(0, 0, 0);
  CHECK(select_vertices(everything, loose).size() == 45);
  CHECK(select_vertices({SelectNearest{{0, 0, 0}, 1}}, loose) == std::vector<Index>{0});
  CHECK(select_vertices({SelectVertices{{45}}}, loose).empty());
}

TEST_CASE("an index beyond the mesh is named") {
  CHECK_THROWS_WITH_AS(select_vertices({SelectVertices{{0, 45}}}, mesh, "/boundary/0/where"),
                       "/boundary/0/where/vertices/1: 45, must be from 0 to 44: the mesh has 45 vertices",
                       InputError);
  const Selector nested = {SelectAnyOf{{everything, negation({SelectTetrahedra{{-1}}})}}};
  CHECK_THROWS_WITH_AS(
      select_tets(nested, mesh, "/regions/0/where"),
      "/regions/0/where/any_of/1/not/tetrahedra/0: -1, must be from 0 to 95: the mesh has 96 "
      "tetrahedra",
      InputError);
}
