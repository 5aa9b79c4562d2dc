#include "lobe/fem/volume_term.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "lobe/fem/shape.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {
constexpr double kappa = 1e5;
Mat3<double> some_gradient() {
  Mat3<double> H;
  H << 0.3, -0.2, 0.1, 0.4, 0.2, -0.3, -0.1, 0.2, -0.25;
  return H;
}
}  // namespace

TEST_CASE("the change of volume is det F − 1, exact for tiny gradients") {
  const Mat3<double> H = some_gradient();
  CHECK(volume_change(H) == near((Mat3<double>::Identity() + H).determinant() - 1, 1e-14));
  CHECK(volume_change<double>(1e-12 * Mat3<double>::Identity()) == near(3e-12, 1e-11));
  CHECK(volume_ratio(H) == near(1 + volume_change(H), 1e-14));
}

TEST_CASE("the volume stress is the derivative of κ|v|³/3, stretched and inverted") {
  for (double scale : {1.0, -1.0, -4.0}) {
    const Mat3<double> H = scale * some_gradient();
    const Mat3<double> P = volume_stress(H, kappa);
    const double h = 1e-6;
    for (int i = 0; i < 9; ++i) {
      Mat3<double> plus = H, minus = H;
      plus(i) += h;
      minus(i) -= h;
      const double slope =
          (volume_energy_density(plus, kappa) - volume_energy_density(minus, kappa)) / (2 * h);
      CHECK(P(i) == near(slope, 1e-6, P.norm()));
    }
  }
}

TEST_CASE("its diagonal block is the derivative of the force on a vertex that moves alone") {
  const Mat3<double> H = some_gradient();
  const Vec3d alpha(0.7, -1.1, 0.4);
  const Mat3<double> block = volume_diagonal_block(H, alpha, kappa);
  const double h = 1e-6;
  for (int d = 0; d < 3; ++d) {
    const Mat3<double> move = Vec3d::Unit(d) * alpha.transpose() * h;
    const Vec3d slope =
        (volume_stress<double>(H + move, kappa) - volume_stress<double>(H - move, kappa)) * alpha / (2 * h);
    CHECK((block.col(d) - slope).norm() < 1e-6 * block.norm());
  }
}

TEST_CASE("erratum 4: the force of the volume energy conserves momentum, the printed unit normals do not") {
  Mat34<double> X;
  X << 0, 1, 0, 0.2, 0, 0.1, 1, 0, 0, 0, 0.3, 1.5;
  const Shape s = shape(X);
  const Mat3<double> H = some_gradient();
  const Mat34<double> x = X + H * X;
  const double v = volume_change(H);
  const Mat34<double> f =
      corner_forces<double>(s.volume * volume_stress(H, kappa), s.gradients.rightCols<3>());
  CHECK(f.rowwise().sum().norm() < 1e-12 * f.norm());
  Vec3d moment = Vec3d::Zero(), printed_sum = Vec3d::Zero();
  for (int p = 0; p < 4; ++p) {
    moment += Vec3d(x.col(p)).cross(Vec3d(f.col(p)));
    const Vec3d a = x.col((p + 1) % 4), b = x.col((p + 2) % 4), c = x.col((p + 3) % 4);
    Vec3d area = (b - a).cross(c - a) / 2;  // of the opposite face, turned towards p
    if (area.dot(x.col(p) - a) < 0) area = -area;
    // ∂V/∂x_p = a third of it
    CHECK((f.col(p) + kappa * v * std::abs(v) * area / 3).norm() < 1e-12 * f.norm());
    printed_sum += v * v * area.normalized();
  }
  CHECK(moment.norm() < 1e-12 * f.norm());
  CHECK(printed_sum.norm() > 1e-3 * v * v);
}
