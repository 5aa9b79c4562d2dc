#include "lobe/skin/carriers.h"

#include <doctest/doctest.h>

#include <set>

#include "lobe/skin/skin.h"
#include "textured.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a face of the boundary lies on its own tetrahedron alone") {
  const TetMesh mesh = irregular_box(4);
  const Topology topology(mesh);
  const TexturedSurface boundary = textured_boundary(mesh);
  const NumberLists under = tets_under(boundary.points, boundary.triangles, mesh);
  REQUIRE(under.count() == boundary.triangles.cols());
  for (Index i = 0; i < under.count(); ++i) {
    REQUIRE(under[i].size() == 1);
    CHECK(under[i][0] == topology.boundary_faces()[i] / 4);
  }
}

TEST_CASE("a triangle across a mesh lies on what is under both of its ends") {
  const TetMesh mesh = box_mesh({0.04, 0.01, 0.01}, 4, 1, 1);
  Mat3X<double> points(3, 3);
  points << 0, 0.04, 0.04, /**/ 0.005, 0.002, 0.008, /**/ 0.012, 0.012, 0.012;
  Triangles triangle(3, 1);
  triangle << 0, 1, 2;
  const NumberLists under = tets_under(points, triangle, mesh);
  std::set<Index> cells;
  for (Index t : under[0]) cells.insert(t / 6);
  CHECK(cells == std::set<Index>{0, 1, 2, 3});
}

TEST_CASE("lists turned round say who has a number") {
  NumberLists lists;
  lists.append(std::vector<Index>{3, 1});
  lists.append({});
  lists.append(std::vector<Index>{1});
  const NumberLists who = inverse(lists, 5);
  REQUIRE(who.count() == 5);
  CHECK(std::vector<Index>(who[1].begin(), who[1].end()) == std::vector<Index>{0, 2});
  CHECK(std::vector<Index>(who[3].begin(), who[3].end()) == std::vector<Index>{0});
  CHECK((who[0].empty() && who[2].empty() && who[4].empty()));
}

TEST_CASE("tetrahedra hang together by shared corners, and no more where a cut has taken one from them") {
  const TetMesh box = box_mesh({0.03, 0.01, 0.01}, 3, 1, 1);
  const Topology topology(box);
  CHECK(bond(topology, std::vector<Index>{0}) == Bond::firm);
  CHECK(bond(topology, std::vector<Index>{0, 3, 6, 9}) == Bond::firm);
  CHECK(bond(topology, std::vector<Index>{0, 12}) == Bond::loose);  // of the first and the last cell
  CHECK(bond(topology, std::vector<Index>{0, 12, 6, 9, 7, 8, 10, 11}) == Bond::firm);

  Topology single(irregular_box(3));
  const std::vector<Index> star(single.around(21).begin(), single.around(21).end());
  const auto share_face = [&](Index a, Index b) {
    for (int f = 0; f < 4; ++f)
      if (single.neighbour(a, f) == b) return true;
    return false;
  };
  Index other = -1;
  for (Index t : star)
    if (t != star[0] && !share_face(star[0], t)) other = t;
  REQUIRE(other >= 0);
  const std::vector<Index> two{star[0], other};
  CHECK(bond(single, two) == Bond::firm);
  std::vector<Index> others;
  for (Index t = 0; t < single.tet_count(); ++t)
    if (t != star[0] && t != other) others.push_back(t);
  single.remove(others);
  CHECK(bond(single, two) == Bond::none);
  CHECK(bond(single, std::vector<Index>{star[0], others[0]}) == Bond::none);
}
