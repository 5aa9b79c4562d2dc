// How stiff the whole body is against a tool that moves some vertices as one: way (d) of `lobe bench haptic`,
// and what patches are compared with in tests.
#pragma once

#include <array>
#include <stdexcept>
#include <vector>

#include "lobe/sim/world.h"
#include "lobe/solve/tangent.h"

namespace lobe::bench {

// About the present state: minus the force on the contact when it is moved by a unit, all else in balance
// [N/m].
inline Mat3<double> static_stiffness(World<double>& world, const std::vector<Index>& contact) {
  HeldVertices held = world.held();
  for (Index v : contact) held.hold({v, 1, Vec3d::Zero(), Vec3d::Zero()});
  const Unknowns unknowns = free_components(world.elements(), held);
  Tangent tangent(world.elements(), unknowns);
  const Mat3X<double> u = world.displacements();
  tangent.update(u);
  const auto factor = tangent.make_factor(make_ldlt);
  bool damped = false;
  if (!tangent.factorise(*factor, damped)) throw std::runtime_error("the body has no stiffness");
  std::array<Mat3X<double>, 3> moved;
  for (int axis = 0; axis < 3; ++axis) {
    Mat3X<double> w = Mat3X<double>::Zero(3, u.cols());
    for (Index v : contact) w(axis, v) = 1;
    const Eigen::VectorXd x = tangent.solve(*factor, Eigen::VectorXd::Zero(unknowns.count), u, w);
    moved[std::size_t(axis)] = w + unknowns.scatter(x);
  }
  // As a quadratic form, in which what is off in the solution is squared.
  Mat3<double> K;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double h = 1e-7;
    const Mat3X<double> way = h * moved[std::size_t(axis)];
    const Mat3X<double> forces = energy_and_forces(world.elements(), u + way).forces -
                                 energy_and_forces(world.elements(), u - way).forces;
    for (int other = 0; other < 3; ++other)
      K(other, axis) = -(moved[std::size_t(other)].array() * forces.array()).sum() / (2 * h);
  }
  return K;
}

}  // namespace lobe::bench
