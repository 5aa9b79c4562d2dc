#include "lobe/fem/shape.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

using namespace lobe;

namespace {
Mat34<double> corners() {
  Mat34<double> X;
  X << 0.1, 1.2, 0.0, 0.3, 0.0, 0.1, 0.9, -0.2, 0.0, 0.2, 0.1, 1.1;
  return X;
}
}  // namespace

TEST_CASE("shape gradients reproduce the gradient of every affine field") {
  const Mat34<double> X = corners();
  const Shape s = shape(X);
  Mat3<double> G;
  G << 1, 2, 3, -4, 5, 6, 7, 8, -9;
  CHECK((G * X * s.gradients.transpose() - G).norm() < 1e-13);
  CHECK(s.gradients.rowwise().sum().norm() < 1e-14);
  const Mat3<double> alpha = s.gradients.rightCols<3>();
  const Mat34<double> u = G * X;
  CHECK((displacement_gradient(u, alpha) - G).norm() < 1e-13);
}

TEST_CASE("erratum 2: the printed shape vector is minus the gradient for a positively oriented tetrahedron") {
  const Mat34<double> X = corners();
  const Shape s = shape(X);
  REQUIRE(s.volume > 0);
  for (int i = 0; i < 4; ++i) {
    // [PDA] section 2.1: (−1)^i (X_j × X_k + X_k × X_l + X_l × X_j) / 6V, j, k, l the other corners in order
    const Vec3d j = X.col((i + 1) % 4), k = X.col((i + 2) % 4), l = X.col((i + 3) % 4);
    const double sign = i % 2 == 0 ? 1 : -1;
    const Vec3d printed = sign * (j.cross(k) + k.cross(l) + l.cross(j)) / (6 * s.volume);
    CHECK((printed + s.gradients.col(i)).norm() < 1e-12 * s.gradients.col(i).norm());
  }
}

TEST_CASE(
    "corner forces of any stress sum to zero force and, for a symmetric Kirchhoff stress, to zero moment") {
  const Mat34<double> X = corners();
  const Shape s = shape(X);
  Mat3<double> P;
  P << 3, 1, 2, 1, -4, 5, 2, 5, 6;  // F = I: P is symmetric
  const Mat34<double> f = corner_forces<double>(s.volume * P, s.gradients.rightCols<3>());
  CHECK(f.rowwise().sum().norm() < 1e-14);
  Vec3d moment = Vec3d::Zero();
  for (int c = 0; c < 4; ++c) moment += Vec3d(X.col(c)).cross(Vec3d(f.col(c)));
  CHECK(moment.norm() < 1e-13);
}
