#include "lobe/fem/guard.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "lobe/fem/shape.h"
#include "lobe/numerics/simd.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {
constexpr double modulus = 6e4, below = 0.2;

// A gradient with shear and rotation whose det F is J.
Mat3<double> gradient_of(double J) {
  Mat3<double> F;
  F << 1.1, -0.2, 0.1, 0.3, 0.9, -0.3, -0.1, 0.2, 1;
  F.col(0) *= J / (1 + volume_change<double>(F - Mat3<double>::Identity()));
  return F - Mat3<double>::Identity();
}
constexpr double ratios[] = {0.199, 0.15, 0.1,  0.06, 0.05,
                             0.04,  0.0,  -0.3, -2.0};  // barrier, then its extension
}  // namespace

TEST_CASE("at half of the threshold the guard's energy is M J₀²/4, at zero volume 9 M J₀²") {
  CHECK(guard_energy_density(gradient_of(below / 2), modulus, below) ==
        near(modulus * below * below / 4, 1e-12));
  CHECK(guard(0.0, below).energy == near(9 * below * below, 1e-12));
  CHECK(guard(0.0, below).slope == near(-45 * below, 1e-12));
}

TEST_CASE("above its threshold the guard is exactly zero") {
  for (double J : {0.2 + 1e-12, 0.3, 1.0, 2.0}) {
    CHECK(guard_energy_density(gradient_of(J), modulus, below) == 0);
    CHECK(guard_stress(gradient_of(J), modulus, below).isZero(0));
    CHECK(guard_diagonal_block<double>(gradient_of(J), Vec3d(1, 2, 3), modulus, below).isZero(0));
  }
}

TEST_CASE("value, slope and curvature are continuous at the threshold and where the extension begins") {
  for (double J : {below, below / 4}) {
    const double h = 1e-9;
    const Guard<double> under = guard(J - h, below), over = guard(J + h, below);
    CHECK(under.energy == near(over.energy, 1e-6, below * below));
    CHECK(under.slope == near(over.slope, 1e-6, 45 * below));   // what the slope comes to at J = 0
    CHECK(under.curvature == near(over.curvature, 1e-6, 126));  // its largest value
  }
}

TEST_CASE("the force of the guard only grows towards collapse and beyond, its curvature stays below 126 M") {
  double last = 0;
  for (double J = below; J > -3; J -= 1e-3) {
    const Guard<double> g = guard(J, below);
    CHECK(-g.slope >= last);
    CHECK(g.curvature <= 126 * (1 + 1e-12));
    last = -g.slope;
  }
}

TEST_CASE("the guard's stress is the slope of its energy, near the threshold, at zero volume and inverted") {
  for (double J : ratios) {
    const Mat3<double> H = gradient_of(J), P = guard_stress(H, modulus, below);
    const double h = 1e-7;
    for (int i = 0; i < 9; ++i) {
      Mat3<double> plus = H, minus = H;
      plus(i) += h;
      minus(i) -= h;
      const double slope =
          (guard_energy_density(plus, modulus, below) - guard_energy_density(minus, modulus, below)) /
          (2 * h);
      CHECK(P(i) == near(slope, 1e-6, P.norm()));
    }
  }
}

TEST_CASE("the guard's diagonal block is the derivative of the force on a vertex that moves alone") {
  const Vec3d alpha(0.7, -1.1, 0.4);
  for (double J : ratios) {
    const Mat3<double> H = gradient_of(J), block = guard_diagonal_block(H, alpha, modulus, below);
    const double h = 1e-8;
    for (int d = 0; d < 3; ++d) {
      const Mat3<double> move = Vec3d::Unit(d) * alpha.transpose() * h;
      const Vec3d slope =
          (guard_stress<double>(H + move, modulus, below) - guard_stress<double>(H - move, modulus, below)) *
          alpha / (2 * h);
      CHECK((block.col(d) - slope).norm() < 1e-5 * block.norm());
    }
  }
}

TEST_CASE("rotations do not change the guard's energy and turn its stress") {
  const Mat3<double> Q = Eigen::AngleAxisd(2.5, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  for (double J : ratios) {
    const Mat3<double> H = gradient_of(J), F = H + Mat3<double>::Identity();
    const Mat3<double> turned = Q * F - Mat3<double>::Identity();
    CHECK(guard_energy_density(turned, modulus, below) ==
          near(guard_energy_density(H, modulus, below), 1e-10));
    const Mat3<double> P = guard_stress(H, modulus, below);
    CHECK((guard_stress(turned, modulus, below) - Q * P).norm() < 1e-10 * P.norm());
  }
}

TEST_CASE("the guard's corner forces conserve momentum and angular momentum") {
  Mat34<double> X;
  X << 0, 1, 0, 0.2, 0, 0.1, 1, 0, 0, 0, 0.3, 1.5;
  const Shape s = shape(X);
  for (double J : ratios) {
    const Mat3<double> H = gradient_of(J);
    const Mat34<double> x = X + H * X, f = corner_forces<double>(s.volume * guard_stress(H, modulus, below),
                                                                 s.gradients.rightCols<3>());
    Vec3d moment = Vec3d::Zero();
    for (int c = 0; c < 4; ++c) moment += Vec3d(x.col(c)).cross(Vec3d(f.col(c)));
    CHECK(f.rowwise().sum().norm() < 1e-12 * f.norm());
    CHECK(moment.norm() < 1e-12 * f.norm());
  }
}

TEST_CASE("lanes of a pack are guarded each for itself, as one element is") {
  using Lane = Pack<double>;
  Mat3<Lane> H;
  for (int i = 0; i < 9; ++i)
    H(i) = Lane([&](auto lane) { return gradient_of(ratios[lane % std::size(ratios)])(i); });
  const Mat3<Lane> P = guard_stress(H, Lane(modulus), Lane(below));
  for (std::size_t lane = 0; lane < Lane::size(); ++lane) {
    const Mat3<double> alone = guard_stress(gradient_of(ratios[lane % std::size(ratios)]), modulus, below);
    for (int i = 0; i < 9; ++i) CHECK(double(P(i)[lane]) == near(alone(i), 1e-12, alone.norm()));
  }
}
