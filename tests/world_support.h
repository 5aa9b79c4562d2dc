// What tests ask of a world that is put into a state.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "lobe/sim/validate.h"
#include "lobe/sim/world.h"
#include "near.h"

namespace lobe::test {

template <class Real>
bool same_bits(World<Real>& a, World<Real>& b) {
  return a.time() == b.time() && a.state().u == b.state().u && a.state().v == b.state().v;
}

// What validate() names; nothing if the world is valid.
template <class Real>
std::string fault_of(World<Real>& world) {
  try {
    validate(world);
  } catch (const BrokenInvariant& fault) {
    return fault.what();
  }
  return "";
}

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

// Takes a step. Returns ½ v⁻·M v⁺ + U(u), of the velocities half a step before and after u: central
// differences without damping conserve it of a linear body to rounding, of others but for what is of second
// order in dt. [J]
inline double staggered_energy(World<double>& world, double dt) {
  const Mat3X<double> before = world.state().v;
  const Energies e = world.energies();
  world.step(dt);
  double twice = 0;
  for (Index v = 0; v < before.cols(); ++v)
    twice += world.body().inertia.mass()[std::size_t(v)] * before.col(v).dot(world.state().v.col(v));
  return twice / 2 + e.total() - e.kinetic;
}

// By how much it varies over `steps` steps of dt [s] after the first, relative to what it starts from.
inline double energy_drift(World<double>& world, double dt, int steps) {
  world.step(dt);
  const double start = staggered_energy(world, dt);
  double largest = 0;
  for (int i = 0; i < steps; ++i) largest = std::max(largest, std::abs(staggered_energy(world, dt) - start));
  return largest / start;
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
