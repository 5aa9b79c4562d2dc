#include "lobe/fem/fibre_fields.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "lobe/error.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

std::vector<Index> all_tets(const TetMesh& mesh) {
  std::vector<Index> tets(std::size_t(mesh.tet_count()));
  std::iota(tets.begin(), tets.end(), 0);
  return tets;
}

template <class Holds>
std::vector<Index> vertices_where(const TetMesh& mesh, Holds&& holds) {
  std::vector<Index> found;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (holds(Vec3d(mesh.points.col(v)))) found.push_back(v);
  return found;
}

// A box with fibres from its face x = 0 to its face x = 0.03.
void set_along_x(TetMesh& mesh) {
  mesh.fibres.setZero(3, mesh.tet_count());
  const double length = mesh.points.row(0).maxCoeff();
  set_harmonic_fibres(vertices_where(mesh, [](const Vec3d& X) { return X.x() == 0; }),
                      vertices_where(mesh, [&](const Vec3d& X) { return X.x() == length; }), all_tets(mesh),
                      mesh, "here");
}

}  // namespace

TEST_CASE("the harmonic field between two faces of a box is along its axis") {
  TetMesh mesh = box_mesh({0.03, 0.02, 0.02}, 3, 2, 2);
  set_along_x(mesh);
  for (Index t = 0; t < mesh.tet_count(); ++t) CHECK((mesh.fibres.col(t) - Vec3d::UnitX()).norm() < 1e-12);
}

// log r between the radii a and b: its gradient is radial, and the error of linear elements of first order.
TEST_CASE("the harmonic field between the walls of a tube is radial, to first order in the edge") {
  const auto worst = [](int n) {
    TetMesh mesh = box_mesh({1, 1, 1}, n, 2 * n, 1);  // (radius, angle, height), a quarter of the tube
    const double quarter = std::acos(0.0);
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      const double r = 1 + mesh.points(0, v), angle = quarter * mesh.points(1, v);
      mesh.points.col(v) << r * std::cos(angle), r * std::sin(angle), mesh.points(2, v) / n;
    }
    const auto at_radius = [&](double radius) {
      return vertices_where(
          mesh, [&](const Vec3d& X) { return std::abs(std::hypot(X.x(), X.y()) - radius) < 1e-9; });
    };
    mesh.fibres.setZero(3, mesh.tet_count());
    set_harmonic_fibres(at_radius(1), at_radius(2), all_tets(mesh), mesh, "here");
    double sum = 0;
    for (Index t = 0; t < mesh.tet_count(); ++t) {
      Vec3d radial = barycentre(mesh, t);
      radial.z() = 0;
      sum += (mesh.fibres.col(t) - radial.normalized()).squaredNorm() / double(mesh.tet_count());
    }
    return std::sqrt(sum);
  };
  const double coarse = worst(4), fine = worst(8);
  CHECK(fine < 0.1);
  CHECK(std::log2(coarse / fine) > 0.8);
}

TEST_CASE("tetrahedra within an end take the direction of their neighbours") {
  TetMesh mesh = box_mesh({0.04, 0.01, 0.01}, 4, 1, 1);
  mesh.fibres.setZero(3, mesh.tet_count());
  set_harmonic_fibres(vertices_where(mesh, [](const Vec3d& X) { return X.x() < 0.021; }),
                      vertices_where(mesh, [](const Vec3d& X) { return X.x() > 0.039; }), all_tets(mesh),
                      mesh, "here");
  for (Index t = 0; t < mesh.tet_count(); ++t) CHECK((mesh.fibres.col(t) - Vec3d::UnitX()).norm() < 1e-12);
}

TEST_CASE("fibres around an axis are circles") {
  TetMesh mesh = irregular_box();
  mesh.fibres.setZero(3, mesh.tet_count());
  const Vec3d point(-0.1, 0.2, 0), axis(0, 0, 4);
  set_fibres_around(point, axis, all_tets(mesh), mesh, "here");
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Vec3d arm = barycentre(mesh, t) - point, expected(-arm.y(), arm.x(), 0);
    CHECK((mesh.fibres.col(t) - expected.normalized()).norm() < 1e-14);
  }
}

TEST_CASE("fields do not depend on the numbering of the mesh") {
  TetMesh mesh = irregular_box();
  mesh.fibres.setZero(3, mesh.tet_count());
  const auto low = [&](const TetMesh& m) {
    return vertices_where(m, [](const Vec3d& X) { return X.x() < 0.003; });
  };
  const auto high = [&](const TetMesh& m) {
    return vertices_where(m, [](const Vec3d& X) { return X.x() > 0.027; });
  };
  set_harmonic_fibres(low(mesh), high(mesh), all_tets(mesh), mesh, "here");
  TetMesh other = mesh;  // vertices and tetrahedra in reverse, corners in a cycle of three
  const Index n = mesh.vertex_count(), tets = mesh.tet_count();
  for (Index v = 0; v < n; ++v) other.points.col(v) = mesh.points.col(n - 1 - v);
  for (Index t = 0; t < tets; ++t) {
    const Eigen::Vector4i c = mesh.tets.col(tets - 1 - t);
    other.tets.col(t) << n - 1 - c[0], n - 1 - c[2], n - 1 - c[3], n - 1 - c[1];
  }
  other.fibres.setZero();
  set_harmonic_fibres(low(other), high(other), all_tets(other), other, "here");
  for (Index t = 0; t < tets; ++t) CHECK((other.fibres.col(t) - mesh.fibres.col(tets - 1 - t)).norm() < 1e-9);
}

TEST_CASE("what gives no direction is named") {
  TetMesh mesh = box_mesh({0.03, 0.02, 0.02}, 3, 2, 2);
  mesh.fibres.setZero(3, mesh.tet_count());
  const std::vector<Index> some{0, 1}, none;
  CHECK_THROWS_WITH_AS(set_harmonic_fibres(none, some, all_tets(mesh), mesh, "/f"),
                       "/f/from: selects no vertex of the material's tetrahedra", InputError);
  CHECK_THROWS_WITH_AS(set_harmonic_fibres(some, some, all_tets(mesh), mesh, "/f"),
                       "/f/to: vertex 0 is selected by both ends", InputError);
  CHECK_THROWS_AS(set_fibres_around(barycentre(mesh, 5), Vec3d::UnitZ(), all_tets(mesh), mesh, "/f"),
                  InputError);
}
