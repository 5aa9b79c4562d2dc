#include "lobe/fem/hooke.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "fem/moduli.h"
#include "lobe/fem/shape.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a true rotation by 45 degrees gives the linear model its spurious energy") {
  const Mat3<double> R = Eigen::AngleAxisd(std::numbers::pi / 4, Vec3d::UnitZ()).toRotationMatrix();
  const Mat3<double> H = R - Mat3<double>::Identity();
  CHECK(H(0, 0) == near(-0.292893, 1e-6));
  CHECK(hooke_stress(H, lambda, mu)(0, 0) == near(-29289.3, 1e-5));
  CHECK(hooke_energy_density(H, lambda, mu) == near(8578.6, 1e-5));
}

TEST_CASE("an infinitesimal rotation costs the linear model nothing") {
  Mat3<double> H = Mat3<double>::Zero();
  H(0, 1) = -0.7;
  H(1, 0) = 0.7;
  CHECK(hooke_energy_density(H, lambda, mu) == 0);
  CHECK(hooke_stress(H, lambda, mu).norm() == 0);
}

TEST_CASE("the blocks are the second derivative of the energy") {
  Mat34<double> X, u;
  X << 0, 1, 0, 0.2, 0, 0.1, 1, 0, 0, 0, 0.3, 1;
  u << 0.1, 0.2, -0.1, 0.3, 0, 0.4, 0.1, 0.2, -0.3, 0.2, 0.1, 0;
  const Shape s = shape(X);
  const Mat3<double> H = displacement_gradient<double>(u, s.gradients.rightCols<3>());
  double energy = 0;
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k)
      energy +=
          0.5 * s.volume *
          u.col(j).dot(hooke_block<double>(s.gradients.col(j), s.gradients.col(k), lambda, mu) * u.col(k));
  CHECK(energy == near(s.volume * hooke_energy_density(H, lambda, mu), 1e-13));
}
