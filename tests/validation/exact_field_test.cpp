#include "benchmarks/validation/exact_field.h"

#include <doctest/doctest.h>

using namespace lobe;
using namespace lobe::validation;

namespace {

constexpr double h = 1e-5;
const ExactField field{0.1, Vec3d(0.1, -0.2, 0.3)};
const Vec3d X(0.7, -0.4, 0.9);

}  // namespace

TEST_CASE("gradient and second derivatives of the manufactured field are its differences") {
  const auto dH = field.gradient_derivatives(X);
  for (int j = 0; j < 3; ++j) {
    const Vec3d step = h * Vec3d::Unit(j);
    const Vec3d slope = (field.displacement(X + step) - field.displacement(X - step)) / (2 * h);
    CHECK((field.gradient(X).col(j) - slope).norm() < 1e-9);
    const Mat3<double> change = (field.gradient(X + step) - field.gradient(X - step)) / (2 * h);
    CHECK((dH[j] - change).norm() < 1e-9);
  }
}

TEST_CASE("the body force is minus the divergence of the stress, for each law") {
  const FibreModuli<double> fibre{0.5, 0.8, 3};
  for (const lobe::validation::Law& law :
       {lobe::validation::Law{RegionModel::tensor_mass}, lobe::validation::Law{},
        lobe::validation::Law{RegionModel::nonlinear, 1.25, 1, 2.5},
        lobe::validation::Law{RegionModel::tensor_mass, 1.25, 1, 0, fibre},
        lobe::validation::Law{RegionModel::nonlinear, 1.25, 1, 0, fibre}}) {
    Vec3d divergence = Vec3d::Zero();
    for (int j = 0; j < 3; ++j) {
      const Vec3d step = h * Vec3d::Unit(j);
      divergence +=
          (law.stress(field.gradient(X + step), X + step) - law.stress(field.gradient(X - step), X - step))
              .col(j) /
          (2 * h);
    }
    CHECK((body_force(field, law, X) + divergence).norm() < 1e-8 * divergence.norm());
  }
}

TEST_CASE("the amplitudes of the SVK cases are far from linear: the body force differs by a tenth") {
  const ExactField large{0.05, Vec3d::Zero()};
  const Vec3d at(0.6, 0.6, 1);
  const Vec3d svk = body_force(large, {}, at), linear = body_force(large, {RegionModel::tensor_mass}, at);
  CHECK((svk - linear).norm() > 0.1 * linear.norm());
}
