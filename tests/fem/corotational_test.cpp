// The corotational law: closed forms, and what no other test of the laws says (law_test.cpp has derivatives,
// rotations and lanes).
#include "lobe/fem/corotational.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fem/moduli.h"
#include "lobe/fem/hooke.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/simd.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Law<double> corotational() { return corotational_law({lambda, mu, 1000}); }

const Mat3<double> I = Mat3<double>::Identity();
Mat3<double> turn() { return Eigen::AngleAxisd(2.1, Vec3d(1, -2, 0.5).normalized()).toRotationMatrix(); }

Mat3<double> diagonal_of(double a, double b, double c) { return Vec3d(a, b, c).asDiagonal(); }

}  // namespace

TEST_CASE("of stretches a, b, c the energy is Hooke's of a − 1, b − 1, c − 1, and its slope their stress") {
  const Law<double> law = corotational();
  for (const Vec3d& s : {Vec3d(1.3, 0.9, 0.7), Vec3d(2, 1.5, 0), Vec3d(1.2, 1, -0.4)}) {
    const Vec3d e = s - Vec3d::Ones();
    const Mat3<double> H = turn() * s.asDiagonal() - I;
    CHECK(law_energy_density(law, H) == near(lambda / 2 * e.sum() * e.sum() + mu * e.squaredNorm(), 1e-13));
    const Vec3d stress = Vec3d::Constant(lambda * e.sum()) + 2 * mu * e;
    CHECK((law_stress(law, H) - turn() * Mat3<double>(stress.asDiagonal())).norm() < 1e-13 * stress.norm());
  }
}

TEST_CASE("where a tetrahedron does not turn, it is Hooke's law") {
  Mat3<double> H;  // symmetric
  H << 0.2, 0.05, -0.1, 0.05, -0.15, 0.08, -0.1, 0.08, 0.1;
  CHECK(law_energy_density(corotational(), H) == near(hooke_energy_density(H, lambda, mu), 1e-13));
  const Mat3<double> sigma = hooke_stress(H, lambda, mu);
  CHECK((law_stress(corotational(), H) - sigma).norm() < 1e-13 * sigma.norm());
}

TEST_CASE("small strains have no errors of large numbers, in single precision and turned") {
  Mat3<double> strain;
  strain << 3e-4, 1e-4, 0, 1e-4, -2e-4, 5e-5, 0, 5e-5, 1e-4;
  const Law<float> law = corotational().as<float>();
  using T = Pack<float>;
  Mat3<T> small, turned;
  const Mat3<double> H = turn() * (I + strain) - I;
  for (int i = 0; i < 9; ++i) {
    small(i) = T(float(strain(i)));
    turned(i) = T(float(H(i)));
  }
  const Mat3<T> P = law_stress(law.as<T>(), small), Q = law_stress(law.as<T>(), turned);
  const Mat3<double> exact = law_stress(corotational(), strain), far = law_stress(corotational(), H);
  for (int i = 0; i < 9; ++i) {
    CHECK(double(P(i)[0]) == near(exact(i), 1e-6, exact.norm()));
    CHECK(double(Q(i)[0]) == near(far(i), 2e-3, far.norm()));  // H has roundings of 6e-8 beside 3e-4
  }
}

TEST_CASE("an inverted tetrahedron is pushed back, until it is whole") {
  double before = law_energy_density(corotational(), diagonal_of(0, 0, -1.9));
  for (double s = -0.85; s < 0.99; s += 0.05) {  // of the third stretch
    const Mat3<double> H = diagonal_of(0, 0, s - 1);
    CHECK(law_stress(corotational(), H)(2, 2) < 0);
    const double energy = law_energy_density(corotational(), H);
    CHECK(energy < before);
    before = energy;
  }
}

TEST_CASE("all is finite where two rotations are as near") {
  const Mat34<double> alpha = (Mat34<double>() << 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1, -1).finished();
  for (const Mat3<double>& F :
       {diagonal_of(1, 1, -1), diagonal_of(0, 0, 0), diagonal_of(2, 1, -1), diagonal_of(1, 0, 0)}) {
    CHECK(std::isfinite(law_energy_density<double>(corotational(), F - I)));
    CHECK(law_stress<double>(corotational(), F - I).allFinite());
    CHECK(law_stiffness<double>(corotational(), F - I, alpha).allFinite());
    CHECK(law_diagonal_block<double>(corotational(), F - I, alpha.col(0)).allFinite());
  }
}

// It rises to a ridge from both sides, and is the same there.
TEST_CASE("the energy has no jump where the nearest rotation does") {
  const auto energy = [](double s) { return law_energy_density(corotational(), diagonal_of(0.4, 0, s - 1)); };
  const double ridge = energy(-1);
  for (double step : {1e-3, 1e-6, 1e-9}) {
    CHECK(energy(-1 + step) == near(ridge, 20 * step));
    CHECK(energy(-1 - step) == near(ridge, 20 * step));
  }
}
