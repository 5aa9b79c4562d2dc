// Comparing fields of different meshes.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "folder.h"
#include "lobe/diagnostics/compare.h"
#include "lobe/diagnostics/overlap.h"
#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/refine.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class Function>
Field field(const TetMesh& mesh, const Function& u) {
  Field f{"field", mesh, Mat3X<double>(3, mesh.vertex_count()), {}};
  for (Index v = 0; v < mesh.vertex_count(); ++v) f.u.col(v) = u(Vec3d(mesh.points.col(v)));
  return f;
}

Vec3d smooth(const Vec3d& X) {
  return {std::sin(3 * X[0]) * std::cos(2 * X[1]), X[0] * X[0] * X[2], std::exp(X[1] - X[2])};
}

Vec3d nothing(const Vec3d&) { return Vec3d::Zero(); }

// A box whose inner vertices are moved, so that its tetrahedra share nothing with those of another.
TetMesh uneven_cube(int n) {
  TetMesh mesh = box_mesh({1, 1, 1}, n, n, n);
  const Mat3X<double> shift = random_displacement(mesh.vertex_count(), 0.2 / n);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d X = mesh.points.col(v);
    if (X.minCoeff() > 0 && X.maxCoeff() < 1) mesh.points.col(v) += shift.col(v);
  }
  return mesh;
}

std::string refusal(const Field& a, const Field& b) {
  try {
    compare_fields(a, b);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

}  // namespace

TEST_CASE("affine fields of different meshes have their exact norms") {
  // On the unit cube b = (x, 0, 0): ∫|b|² = 1/3, ∫|∇b|² = 1. a − b = (0, 0.1 y, 0): the same shape, a tenth.
  const auto b = [](const Vec3d& X) { return Vec3d(X[0], 0, 0); };
  const auto a = [](const Vec3d& X) { return Vec3d(X[0], 0.1 * X[1], 0); };
  for (const auto& [n, m] : {std::pair{2, 5}, {5, 2}, {3, 3}}) {
    const TetMesh box = box_mesh({1, 1, 1}, m, m, m);
    const Difference d = compare_fields(field(uneven_cube(n), a), field(box, b));
    CHECK_FALSE(d.same_mesh);
    CHECK(d.l2 == near(0.1, 1e-12));
    CHECK(d.h1 == near(0.1, 1e-12));
    CHECK(d.max == near(0.1, 1e-12));
    CHECK(d.relative_max == near(0.1, 1e-12));
    CHECK(d.volume_a == near(2.2, 1e-12));
    CHECK(d.volume_b == near(2, 1e-12));
    CHECK(d.rest_volume_a == near(1, 1e-12));
    CHECK(d.outside_fraction == 0);
    CHECK(d.largest_gap == 0);
  }
}

TEST_CASE("the reference's density weighs the L2 norm, on one mesh and on two") {
  // b = (x, 0, 0), a − b = (1, 0, 0); density 3 for x > 1/2, else 1: ∫ρ = 2, ∫ρx² = (1 + 3 · 7)/24.
  const auto a = [](const Vec3d& X) { return Vec3d(X[0] + 1, 0, 0); };
  Field b = field(box_mesh({1, 1, 1}, 4, 4, 4), [](const Vec3d& X) { return Vec3d(X[0], 0, 0); });
  for (Index t = 0; t < b.mesh.tet_count(); ++t) b.density.push_back(barycentre(b.mesh, t).x() > 0.5 ? 3 : 1);
  for (const TetMesh& mesh : {b.mesh, uneven_cube(3)}) {
    const Difference d = compare_fields(field(mesh, a), b);
    CHECK(d.by_mass);
    CHECK(d.l2 == near(std::sqrt(2 * 24.0 / 22), 1e-12));
    CHECK(d.h1 < 1e-12);
  }
}

TEST_CASE("equal meshes are compared exactly; a mesh refined by itself gives the same figures") {
  const TetMesh mesh = irregular_box(3);
  Field a{"a", mesh, random_displacement(mesh.vertex_count(), 1e-3, 1), {}};
  Field b{"b", mesh, random_displacement(mesh.vertex_count(), 1e-3, 2), {}};
  const Difference same = compare_fields(a, b);
  CHECK(same.same_mesh);
  CHECK(same.l2 == compare_displacements(mesh, a.u, b.u).l2);
  const RefinedMesh fine = refine(mesh);
  const Field fine_a{"a", fine.mesh, fine.prolongate(a.u), {}},
      fine_b{"b", fine.mesh, fine.prolongate(b.u), {}};
  for (const Difference& d : {compare_fields(fine_a, b), compare_fields(a, fine_b)}) {
    CHECK(d.l2 == near(same.l2, 1e-10));
    CHECK(d.h1 == near(same.h1, 1e-10));
    CHECK(d.max == near(same.max, 1e-10));
  }
}

TEST_CASE("interpolants of a smooth field differ by O(h²) in L2 and O(h) in H1") {
  double l2[3], h1[3];
  for (int i = 0; i < 3; ++i) {
    const TetMesh coarse = box_mesh({1, 1, 1}, 2 << i, 2 << i, 2 << i);
    const Difference d = compare_fields(field(coarse, smooth), field(uneven_cube(17), smooth));
    l2[i] = d.l2;
    h1[i] = d.h1;
  }
  CHECK(l2[0] / l2[1] == near(4, 0.1));
  CHECK(h1[0] / h1[1] == near(2, 0.1));
  const TetMesh coarse = box_mesh({1, 1, 1}, 4, 4, 4);  // nested: exact integrals, cleaner orders
  const RefinedMesh fine = refine(coarse);
  const Difference once = compare_fields(field(coarse, smooth), field(fine.mesh, smooth));
  const Difference twice = compare_fields(field(fine.mesh, smooth), field(refine(fine.mesh).mesh, smooth));
  CHECK(once.l2 / twice.l2 == near(4, 0.05));
  CHECK(once.h1 / twice.h1 == near(2, 0.05));
}

TEST_CASE("a kink inside the reference's tetrahedra costs little accuracy") {
  // a = (|x − 1/2|, 0, 0) on two layers, b = (x, 0, 0) on three: ∫|a − b|² = 1/6, ∫|b|² = 1/3.
  const auto kink = [](const Vec3d& X) { return Vec3d(std::abs(X[0] - 0.5), 0, 0); };
  const auto straight = [](const Vec3d& X) { return Vec3d(X[0], 0, 0); };
  const Difference d = compare_fields(field(box_mesh({1, 1, 1}, 2, 2, 2), kink),
                                      field(box_mesh({1, 1, 1}, 3, 3, 3), straight));
  CHECK(d.l2 == near(std::sqrt(0.5), 0.002));
}

TEST_CASE("the difference of two fields does not depend much on which is the reference") {
  const auto other = [](const Vec3d& X) { return Vec3d(1.05 * smooth(X) + Vec3d(0, 0.02, 0)); };
  const Field a = field(uneven_cube(8), smooth), b = field(box_mesh({1, 1, 1}, 7, 7, 7), other);
  const double norm_a = compare_fields(field(a.mesh, nothing), a).l2;
  CHECK(norm_a == 1);
  const double forth = compare_fields(a, b).l2, back = compare_fields(b, a).l2;
  CHECK(forth == near(back, 0.06));  // relative to fields that differ by 5 %
}

TEST_CASE("what lies outside a chord of a curved surface is counted, and takes the linear extension") {
  // A's surface has 12 sides, B's has 24, whose every other vertex lies above the middle of a side of A.
  const double radius = 0.03;
  const auto affine = [](const Vec3d& X) { return Vec3d(0.1 * X[1], 0.2 * X[0], 0.3 * X[2] + 0.01); };
  const Field a = field(cylinder_mesh(radius, 0.1, 2, 4), affine);
  const Field b = field(cylinder_mesh(radius, 0.1, 4, 8), affine);
  const Difference d = compare_fields(a, b);
  CHECK(d.l2 < 1e-13);
  CHECK(d.h1 < 1e-12);
  CHECK(d.max < 1e-15);
  const double sagitta = radius * (1 - std::cos(std::numbers::pi / 12));
  CHECK(d.largest_gap < sagitta);
  CHECK(d.largest_gap > sagitta / 4);  // of points of the quadrature, which lie inside B
  CHECK(d.outside_fraction > 0);
  CHECK(d.outside_fraction < 1.5 * (1 - d.rest_volume_a / d.rest_volume_b));
  CHECK(compare_fields(b, a).outside_fraction == 0);
}

TEST_CASE("two cuts of one mesh are compared on their own sides of a split") {
  // Two half cubes that share no vertex: one at rest, one moved by 1. B has lost a tetrahedron.
  TetMesh halves = box_mesh({0.5, 1, 1}, 2, 4, 4);
  const Index vertices = halves.vertex_count(), tets = halves.tet_count();
  halves.points.conservativeResize(3, 2 * vertices);
  halves.points.rightCols(vertices) = halves.points.leftCols(vertices).colwise() + Vec3d(0.5, 0, 0);
  halves.tets.conservativeResize(4, 2 * tets);
  halves.tets.rightCols(tets) = halves.tets.leftCols(tets).array() + vertices;
  halves.labels.clear();
  Field a{"a", halves, Mat3X<double>::Zero(3, 2 * vertices), {}}, b = a;
  a.u.rightCols(vertices).row(2).setOnes();
  b.u = a.u;
  b.mesh.tets.conservativeResize(4, 2 * tets - 1);
  for (const auto& [from, to] : {std::pair{&a, &b}, {&b, &a}}) {
    const Difference d = compare_fields(*from, *to);
    CHECK_FALSE(d.same_mesh);
    CHECK(d.l2 < 1e-12);
    CHECK(d.h1 < 1e-12);
    CHECK(d.max < 1e-12);
  }
  CHECK(compare_fields(b, a).outside_fraction == near(1.0 / (2 * tets), 1e-12));
}

TEST_CASE("fields that cannot be compared are refused with the reason, never with a number") {
  const auto cube = [](double edge) { return box_mesh(Vec3d::Constant(edge), 6, 6, 6); };
  Field a = field(cube(1), smooth);
  a.name = "a.vtu";
  Field b = field(uneven_cube(5), smooth);
  b.name = "b.vtu";
  CHECK(refusal(a, b) == "accepted");
  const Field millimetres = field(cube(1000), nothing);
  CHECK(contains(refusal(millimetres, b), "millimetres"));
  CHECK(contains(refusal(a, {"mm", millimetres.mesh, millimetres.u, {}}), "millimetres"));
  CHECK(contains(refusal(field(cube(1.5), nothing), b), "m³ at rest against"));
  Field away = a;
  away.mesh.points.row(0).array() += 0.4;
  CHECK(contains(refusal(away, b), "does not cover the same body as b.vtu: "));
  CHECK(contains(refusal(away, b), "% of b.vtu is more than an edge away"));
  Field bad = b;
  bad.u(1, 12) = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(refusal(a, bad), "b.vtu: vertex 12: its displacement is not a finite number"));
  CHECK(contains(refusal(bad, a), "b.vtu: vertex 12"));
  bad = b;
  bad.mesh.tets.resize(4, 0);
  CHECK(contains(refusal(a, bad), "b.vtu: has no tetrahedron"));
  bad = b;
  bad.u.resize(3, 2);
  CHECK(contains(refusal(a, bad), "one displacement per vertex"));
  bad = b;
  bad.density.assign(std::size_t(b.mesh.tet_count()), 1000);
  CHECK(refusal(a, bad) == "accepted");
  bad.density[3] = 0;
  CHECK(contains(refusal(a, bad), "b.vtu: tetrahedron 3: its cell data \"density\" is 0"));
  bad.density.resize(3);
  CHECK(contains(refusal(a, bad), "one density per tetrahedron"));
}

TEST_CASE("a field is read with its density; a file without displacement is refused") {
  const Folder folder;
  const TetMesh mesh = irregular_box(2);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 1e-3);
  const Eigen::MatrixXd density = Eigen::MatrixXd::Constant(1, mesh.tet_count(), 1060);
  write_vtu(folder.path / "full.vtu", mesh, {{"displacement", u}}, {{"density", density}});
  write_vtu(folder.path / "bare.vtu", mesh, {{"displacement", u}});
  write_vtu(folder.path / "none.vtu", mesh);
  CHECK(read_field(folder.path / "full.vtu").density ==
        std::vector<double>(std::size_t(mesh.tet_count()), 1060));
  CHECK(read_field(folder.path / "full.vtu").u == u);
  CHECK(read_field(folder.path / "bare.vtu").density.empty());
  CHECK_THROWS_AS(read_field(folder.path / "none.vtu"), InputError);
  CHECK_THROWS_AS(read_field(folder.path / "missing.vtu"), InputError);
}
