#include "lobe/solve/modes.h"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>

#include "lobe/error.h"
#include "lobe/solve/static_equations.h"
#include "lobe/solve/static_solver.h"
#include "lobe/solve/tangent.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup held_box() {
  Setup setup = setup_of(irregular_box(3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.005) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -9.81};
  return setup;
}

// All frequencies, by the dense problem of differences of forces.
Eigen::VectorXd dense_frequencies(const Setup& setup, const Mat3X<double>& u) {
  const Elements elements(setup);
  const Unknowns unknowns = static_equations(setup, elements).unknowns;
  Mat3X<double> masses(3, u.cols());
  for (Index v = 0; v < masses.cols(); ++v) masses.col(v).setConstant(lumped_mass(elements, v));
  Eigen::MatrixXd K(unknowns.count, unknowns.count);
  const double h = 1e-6;
  for (Index j = 0; j < unknowns.count; ++j) {
    const Mat3X<double> way = unknowns.scatter(h * Eigen::VectorXd::Unit(unknowns.count, j));
    K.col(j) = unknowns.gather(energy_and_forces(elements, u - way).forces -
                               energy_and_forces(elements, u + way).forces) /
               (2 * h);
  }
  const Eigen::VectorXd scale = unknowns.gather(masses).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd A = scale.asDiagonal() * ((K + K.transpose()) / 2) * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues().cwiseSqrt();
}

}  // namespace

TEST_CASE("the lowest frequencies are those of the dense problem, at rest and under load") {
  for (const Setup& setup : {held_box(), smoothed(held_box()), averaged(held_box())}) {
    const StaticResult hanging = solve_static(setup);
    REQUIRE(hanging.converged);
    for (const Mat3X<double>& u : {Mat3X<double>(Mat3X<double>::Zero(3, hanging.u.cols())), hanging.u}) {
      const Eigen::VectorXd found = lowest_frequencies(setup, u, 5), all = dense_frequencies(setup, u);
      for (int i = 0; i < 5; ++i) CHECK(found[i] == near(all[i], 1e-6));
    }
  }
}

TEST_CASE("more frequencies than a body has are refused") {
  const Setup setup = held_box();
  const Mat3X<double> rest = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  CHECK_THROWS_AS(lowest_frequencies(setup, rest, 100000), InputError);
}
