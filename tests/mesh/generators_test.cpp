#include "lobe/mesh/generators.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lobe/error.h"
#include "lobe/sort_unique.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a box mesh fills its box with positive tetrahedra") {
  TetMesh mesh = box_mesh({3, 2, 0.5}, 4, 3, 2);
  CHECK(mesh.vertex_count() == 5 * 4 * 3);
  CHECK(mesh.tet_count() == 6 * 4 * 3 * 2);
  CHECK(total_volume(mesh) == near(3, 1e-12));
  CHECK(mesh.points.col(1) == Vec3d(0.75, 0, 0));
  CHECK(mesh.points.col(mesh.vertex_count() - 1) == Vec3d(3, 2, 0.5));
  CHECK(mesh.labels == std::vector<int>(144, 0));
  const PrepareReport report = prepare(mesh, "box");  // checks conformity as far as face counts go
  CHECK(report.reoriented == 0);
  CHECK(report.unreferenced == 0);
}

TEST_CASE("a cylinder mesh fills the inscribed prism and tends to the cylinder") {
  TetMesh mesh = cylinder_mesh(0.1, 0.5, 3, 2);
  CHECK(mesh.vertex_count() == (3 * 3 * 4 + 1) * 3);
  CHECK(mesh.tet_count() == 18 * 9 * 2);
  const double eighteen_gon = 9 * 0.01 * std::sin(std::numbers::pi / 9);
  CHECK(total_volume(mesh) == near(eighteen_gon * 0.5, 1e-12));
  CHECK(prepare(mesh, "cylinder").reoriented == 0);
  const double exact = std::numbers::pi * 0.01 * 0.5;
  const double coarse = exact - total_volume(cylinder_mesh(0.1, 0.5, 4, 1));
  const double fine = exact - total_volume(cylinder_mesh(0.1, 0.5, 8, 1));
  CHECK(coarse / fine == near(4, 0.01));  // second order
}

TEST_CASE("generated meshes are conforming: each inner face is shared by two, the surface is closed") {
  for (const TetMesh& mesh : {box_mesh({1, 1, 1}, 2, 3, 2), cylinder_mesh(1, 1, 3, 2)}) {
    std::vector<std::array<Index, 3>> boundary;
    for (Index t = 0; t < mesh.tet_count(); ++t)
      for (const auto& [a, b, c] : face_corners) {
        std::array<Index, 3> key = {mesh.tets(a, t), mesh.tets(b, t), mesh.tets(c, t)};
        std::sort(key.begin(), key.end());
        const auto found = std::find(boundary.begin(), boundary.end(), key);
        if (found == boundary.end())
          boundary.push_back(key);
        else
          boundary.erase(found);
      }
    // A closed triangulated surface of one sphere-like piece: F = 2 V − 4 with its V vertices.
    std::vector<Index> vertices;
    for (const auto& face : boundary) vertices.insert(vertices.end(), face.begin(), face.end());
    sort_unique(vertices);
    CHECK(boundary.size() == 2 * vertices.size() - 4);
  }
}

TEST_CASE("generators refuse sizes of nothing") {
  CHECK_THROWS_AS(box_mesh({1, 1, 1}, 0, 1, 1), InputError);
  CHECK_THROWS_AS(box_mesh({1, -1, 1}, 1, 1, 1), InputError);
  CHECK_THROWS_AS(box_mesh({1, 1, 1}, 2000, 2000, 2000), InputError);
  CHECK_THROWS_AS(cylinder_mesh(0, 1, 1, 1), InputError);
  CHECK_THROWS_AS(cylinder_mesh(1, 1, 1, 0), InputError);
}
