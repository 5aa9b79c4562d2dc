#include "lobe/mesh/quality.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "lobe/mesh/generators.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a regular tetrahedron has dihedral angles of arccos 1/3 and altitudes of √(2/3) edges") {
  Mat34<double> corners;
  corners << 1, 1, -1, -1, /**/ 1, -1, 1, -1, /**/ 1, -1, -1, 1;  // edge 2√2
  for (const double angle : dihedral_angles(corners)) CHECK(angle == near(70.528779365509308, 1e-12));
  for (const double altitude : altitudes(corners))
    CHECK(altitude == near(std::sqrt(2.0 / 3) * 2 * std::sqrt(2.0), 1e-12));
}

TEST_CASE("dihedral angles come in the order of the edges") {
  Mat34<double> corners;
  corners << 0, 1, 0, 0, /**/ 0, 0, 1, 0, /**/ 0, 0, 0, 1;
  const auto angles = dihedral_angles(corners);
  for (int e = 0; e < 3; ++e) CHECK(angles[static_cast<std::size_t>(e)] == near(90, 1e-12));
  for (int e = 3; e < 6; ++e)
    CHECK(angles[static_cast<std::size_t>(e)] == near(54.735610317245346, 1e-12));  // arctan √2
  const auto heights = altitudes(corners);
  CHECK(heights[0] == near(1 / std::sqrt(3.0), 1e-12));
  CHECK(heights[1] == near(1, 1e-12));
}

TEST_CASE("quality of a box of Kuhn tetrahedra") {
  const Quality quality = mesh_quality(box_mesh({2, 1, 1}, 2, 1, 1));
  CHECK(quality.volume == near(2, 1e-12));
  CHECK(quality.smallest_tet_volume == near(1.0 / 6, 1e-12));
  CHECK(quality.min_dihedral == near(45, 1e-12));
  CHECK(quality.median_min_dihedral == near(45, 1e-12));
  CHECK(quality.max_dihedral == near(90, 1e-12));
  CHECK(quality.smallest_altitude == near(std::sqrt(0.5), 1e-12));
  CHECK(quality.smallest_altitude_ratio == near(std::sqrt(0.5 / 3), 1e-12));
  CHECK(quality.mean_edge == near((3 + 2 * std::sqrt(2.0) + std::sqrt(3.0)) / 6, 1e-12));
  CHECK(quality.box_min == Vec3d(0, 0, 0));
  CHECK(quality.box_max == Vec3d(2, 1, 1));
  const auto& bins = quality.dihedral_histogram;
  CHECK(std::accumulate(bins.begin(), bins.end(), 0) == 6 * 12);
}

TEST_CASE("the worst tetrahedron is found") {
  TetMesh mesh = box_mesh({3, 1, 1}, 3, 1, 1);
  const Index last = mesh.tets(3, 17);
  Mat34<double> corners = tet_points(mesh, 17);
  mesh.points.conservativeResize(3, mesh.vertex_count() + 1);
  mesh.points.rightCols<1>() = 0.01 * corners.col(3) + 0.33 * corners.leftCols<3>().rowwise().sum();
  mesh.tets(3, 17) = mesh.vertex_count() - 1;
  CHECK(last != mesh.tets(3, 17));
  const Quality quality = mesh_quality(mesh);
  CHECK(quality.worst_tet == 17);
  CHECK(quality.smallest_altitude_ratio < 0.01);
}

TEST_CASE("an empty mesh has zeros") {
  const Quality quality = mesh_quality(TetMesh());
  CHECK(quality.volume == 0);
  CHECK(quality.smallest_altitude == 0);
}
