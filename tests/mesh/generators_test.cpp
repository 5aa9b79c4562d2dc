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

TEST_CASE("a ventricle mesh tends to the shell between two ellipsoids") {
  const VentricleShape shape;
  const auto below = [&](double radius, double length) {  // the base, of an ellipsoid
    const double b = shape.base;
    return std::numbers::pi * radius * radius * (b + 2 * length / 3 - b * b * b / (3 * length * length));
  };
  const double exact =
      below(shape.outer_radius, shape.outer_length) - below(shape.inner_radius, shape.inner_length);
  TetMesh mesh = ventricle_mesh(shape, 6, 2);
  CHECK(mesh.tet_count() == 18 * 36 * 2);
  const PrepareReport report = prepare(mesh, "ventricle");
  CHECK(report.reoriented == 0);
  CHECK(mesh.points.row(2).maxCoeff() == near(shape.base, 1e-12));
  CHECK(mesh.points.row(2).minCoeff() == near(-shape.outer_length, 1e-12));
  const double coarse = exact - total_volume(ventricle_mesh(shape, 8, 2));
  const double fine = exact - total_volume(ventricle_mesh(shape, 16, 4));
  CHECK(coarse / fine == near(4, 0.02));  // second order
}

TEST_CASE("the fibres of a ventricle lie in its wall and are as steep inside and outside as asked") {
  VentricleShape shape;
  shape.inner_angle = 1.1;
  shape.outer_angle = -0.7;
  const int layers = 5;
  const TetMesh mesh = ventricle_mesh(shape, 8, layers);
  double steepest = -9, flattest = 9;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Vec3d a = mesh.fibres.col(t), x = tet_points(mesh, t).rowwise().mean();
    CHECK(a.norm() == near(1, 1e-12));
    // Normal of the ellipsoid through x that has the shell's mean half axes: the layers are no homothetic
    // ones.
    const double radius = (shape.inner_radius + shape.outer_radius) / 2,
                 length = (shape.inner_length + shape.outer_length) / 2;
    const Vec3d normal =
        Vec3d(x.x() / (radius * radius), x.y() / (radius * radius), x.z() / (length * length)).normalized();
    CHECK(std::abs(a.dot(normal)) < 0.12);
    const Vec3d sideways = Vec3d(-x.y(), x.x(), 0).normalized();
    const double slope = std::asin(std::clamp(a.dot(normal.cross(sideways)), -1.0, 1.0));
    steepest = std::max(steepest, slope);
    flattest = std::min(flattest, slope);
  }
  const double half_layer = (shape.inner_angle - shape.outer_angle) / layers / 4;
  CHECK(steepest == near(shape.inner_angle - half_layer, 0.02));
  CHECK(flattest == near(shape.outer_angle + half_layer, 0.02));
}

TEST_CASE("a ventricle that is none is refused") {
  VentricleShape thin, open;
  thin.outer_radius = thin.inner_radius;
  open.base = 0.06;
  CHECK_THROWS_WITH_AS(ventricle_mesh(thin, 4, 2), doctest::Contains("larger than those inside"), InputError);
  CHECK_THROWS_WITH_AS(ventricle_mesh(open, 4, 2), doctest::Contains("cuts the inner ellipsoid"), InputError);
}

TEST_CASE("generated meshes are conforming: each inner face is shared by two, the surface is closed") {
  for (const TetMesh& mesh :
       {box_mesh({1, 1, 1}, 2, 3, 2), cylinder_mesh(1, 1, 3, 2), ventricle_mesh({}, 3, 2)}) {
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
