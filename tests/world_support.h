// What tests ask of a world that is put into a state.
#pragma once

#include <doctest/doctest.h>

#include "lobe/sim/world.h"
#include "near.h"

namespace lobe::test {

template <class Real>
World<Real> world_at(const Setup& setup, const Mat3X<Real>& u, int threads = 1) {
  World<Real> world(setup, threads);
  State<Real> state = world.state();
  state.u = u;
  world.set_state(state);
  return world;
}

template <class Real>
Mat3X<Real> forces(const Setup& setup, const Mat3X<Real>& u, int threads = 1) {
  return world_at(setup, u, threads).forces();
}

inline double elastic_energy(const Setup& setup, const Mat3X<double>& u) {
  const Energies e = world_at(setup, u).energies();
  return e.elastic_linear + e.elastic_nonlinear;
}

// Central differences, for a body without loads.
inline void check_that_forces_are_minus_the_slope_of_the_energy(const Setup& setup, const Mat3X<double>& u) {
  const Mat3X<double> f = forces<double>(setup, u);
  const double h = 1e-7;  // [m]
  for (Index i = 0; i < u.size(); ++i) {
    Mat3X<double> plus = u, minus = u;
    plus(i) += h;
    minus(i) -= h;
    const double slope = (elastic_energy(setup, plus) - elastic_energy(setup, minus)) / (2 * h);
    CHECK(f(i) == near(-slope, 1e-5, f.norm()));
  }
}

}  // namespace lobe::test
