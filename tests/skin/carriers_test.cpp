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
  const TexturedSurface boundary = boundary_of(mesh);
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

TEST_CASE("tetrahedra touch where they share a corner, and are apart where a cut has taken it from them") {
  const TetMesh box = box_mesh({0.03, 0.01, 0.01}, 3, 1, 1);
  Topology topology(box);
  for (Index t = 0; t < box.tet_count(); ++t) {
    CHECK(touch(topology, t, t) == Touch::together);
    for (Index s = 0; s < t; ++s) {
      bool share = false;
      for (Index v : topology.corners(t)) share = share || (topology.corners(s).array() == v).any();
      CHECK(touch(topology, s, t) == (share ? Touch::together : Touch::never));
    }
  }
  Topology single(irregular_box(3));
  std::vector<Index> but_two;  // a vertex in the middle keeps two tetrahedra that share it and no face
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
  CHECK(touch(single, star[0], other) == Touch::together);
  for (Index t = 0; t < single.tet_count(); ++t)
    if (t != star[0] && t != other) but_two.push_back(t);
  single.remove(but_two);
  CHECK(touch(single, star[0], other) == Touch::apart);
}
