#include "lobe/scene/select_shares.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/bind_groups.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

TetMesh unit_tetrahedron() {
  TetMesh mesh;
  mesh.points.resize(3, 4);
  mesh.points << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.tets.resize(4, 1);
  mesh.tets << 0, 1, 2, 3;
  mesh.labels = {0};
  return mesh;
}

Selector beyond(double x) { return {SelectPlane{{x, 0, 0}, {1, 0, 0}, SelectPlane::Side::above}}; }

double share_of(const std::vector<SelectedShare>& shares, Index vertex) {
  for (const SelectedShare& s : shares)
    if (s.vertex == vertex) return s.share;
  return 0;
}

double quarters(const TetMesh& mesh, Index vertex) {  // [m³]
  double sum = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (const Index v : mesh.tets.col(t))
      if (v == vertex) sum += signed_volume(tet_points(mesh, t)) / 4;
  return sum;
}

double held_volume(const Selector& selector, const TetMesh& mesh) {
  double sum = 0;
  for (const auto& [vertex, share] : select_shares(selector, mesh, HoldBy::volume))
    sum += share * quarters(mesh, vertex);
  return sum;
}

}  // namespace

// b₁ ≥ ½ is an eighth of the tetrahedron and lies within the quarter of vertex 1.
TEST_CASE("a plane through the middles of three edges holds half of a corner's quarter") {
  const auto shares = select_shares(beyond(0.5), unit_tetrahedron(), HoldBy::volume);
  REQUIRE(shares.size() == 1);
  CHECK(shares[0].vertex == 1);
  CHECK(shares[0].share == near(0.5, 1e-12));
}

// A quarter of each of the three faces around vertex 1, of which it has a third.
TEST_CASE("by area it holds three quarters of what the corner has of the surface") {
  const auto shares = select_shares(beyond(0.5), unit_tetrahedron(), HoldBy::area);
  REQUIRE(shares.size() == 1);
  CHECK(shares[0].vertex == 1);
  CHECK(shares[0].share == near(0.75, 1e-12));
}

TEST_CASE("all of a body is held wholly, what is next to it not at all") {
  const TetMesh mesh = box_mesh({1, 1, 1}, 2, 2, 2);
  for (const HoldBy by : {HoldBy::volume, HoldBy::area}) {
    const auto shares = select_shares({SelectAll{}}, mesh, by);
    CHECK(shares.size() == (by == HoldBy::volume ? 27 : 26));
    for (const SelectedShare& s : shares) CHECK(s.share == 1);
    CHECK(select_shares(beyond(1.5), mesh, by).empty());
  }
}

// Of a plane along faces of the mesh every point is on one side.
TEST_CASE("shares add up to the volume that is selected") {
  const TetMesh mesh = box_mesh({1, 1, 1}, 4, 4, 4);
  CHECK(held_volume(beyond(0.5), mesh) == near(0.5, 1e-12));
  CHECK(held_volume({SelectNot{{beyond(0.5)}}}, mesh) == near(0.5, 1e-12));
  CHECK(held_volume({SelectAllOf{{beyond(0.25), {SelectNot{{beyond(0.75)}}}}}}, mesh) == near(0.5, 1e-12));
  CHECK(held_volume({SelectAnyOf{{beyond(0.75), {SelectNot{{beyond(0.25)}}}}}}, mesh) == near(0.5, 1e-12));
}

// A share above 0.95 counts as 1: at most 5 % of the rim's vertices too much.
TEST_CASE("a ball is held by its volume on every mesh, by whole vertices only roughly") {
  const Selector ball = {SelectSphere{{0.52, 0.47, 0.49}, 0.3}};
  const double truth = 4 * 3.14159265358979 / 3 * 0.027;
  for (const int n : {3, 5, 8}) CHECK(held_volume(ball, box_mesh({1, 1, 1}, n, n, n)) == near(truth, 0.015));
}

TEST_CASE("selectors of tetrahedra have shares by volume") {
  const TetMesh mesh = box_mesh({2, 1, 1}, 2, 1, 1);
  TetMesh labelled = mesh;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    labelled.labels[std::size_t(t)] = barycentre(mesh, t).x() > 1 ? 7 : 0;
  CHECK(held_volume({SelectLabel{{7}}}, labelled) == near(1, 1e-12));
  std::vector<Index> left;
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (barycentre(mesh, t).x() < 1) left.push_back(t);
  CHECK(held_volume({SelectTetrahedra{left}}, mesh) == near(1, 1e-12));
}

TEST_CASE("a surface has shares by area, of its own faces only") {
  const TetMesh mesh = unit_tetrahedron();
  SelectSurface base{{"base"}, {{0, 1, 2}}, true};
  const auto shares = select_shares({base}, mesh, HoldBy::area);
  CHECK(shares.size() == 3);
  const double slant = std::sqrt(3.0);  // twice the areas: 1, 1, 1, √3
  CHECK(share_of(shares, 0) == near(1.0 / 3, 1e-12));
  CHECK(share_of(shares, 1) == near(1 / (2 + slant), 1e-12));
  CHECK_THROWS_WITH_AS(select_shares({base}, mesh, HoldBy::volume, "/where"),
                       doctest::Contains("a surface has no volume"), InputError);
}

TEST_CASE("vertices that are named have no share") {
  for (const Selector& selector :
       {Selector{SelectVertices{{0}}}, Selector{SelectNot{{Selector{SelectNearest{{0, 0, 0}, 2}}}}}})
    CHECK_THROWS_WITH_AS(select_shares(selector, unit_tetrahedron(), HoldBy::volume, "/boundary/0/where"),
                         doctest::Contains("names vertices, which have no volume"), InputError);
}
