#include "lobe/diagnostics/compare.h"

#include <doctest/doctest.h>

#include <cmath>

#include "lobe/error.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("differences of linear fields have their exact norms") {
  // On the unit cube b = (x, 0, 0): ∫|b|² = 1/3, ∫|∇b|² = 1. a − b = (0, 0.1 y, 0): the same shape, a tenth.
  const TetMesh mesh = box_mesh({1, 1, 1}, 3, 4, 5);
  Mat3X<double> a = Mat3X<double>::Zero(3, mesh.vertex_count()), b = a;
  b.row(0) = mesh.points.row(0);
  a = b;
  a.row(1) = 0.1 * mesh.points.row(1);
  const Difference d = compare_displacements(mesh, a, b);
  CHECK(d.l2 == near(0.1, 1e-12));
  CHECK(d.h1 == near(0.1, 1e-12));
  CHECK(d.max == near(0.1, 1e-12));
  CHECK(d.relative_max == near(0.1, 1e-12));
  CHECK(d.volume_a == near(2.2, 1e-12));
  CHECK(d.volume_b == near(2.0, 1e-12));
}

TEST_CASE("a rigid shift has no gradient; equal fields differ by nothing; a zero reference gives infinity") {
  const TetMesh mesh = irregular_box(2);
  const Mat3X<double> b = random_displacement(mesh.vertex_count(), 1e-3);
  const Mat3X<double> shifted = b.colwise() + Vec3d(1e-3, 0, 0);
  CHECK(compare_displacements(mesh, shifted, b).h1 < 1e-12);
  CHECK(compare_displacements(mesh, shifted, b).max == near(1e-3, 1e-12));
  CHECK(compare_displacements(mesh, b, b).l2 == 0);
  CHECK(std::isinf(compare_displacements(mesh, b, 0 * b).l2));
  CHECK_THROWS_AS(compare_displacements(mesh, b, b.leftCols(3)), InputError);
}
