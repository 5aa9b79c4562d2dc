// What a cut must leave as it was, at the instant when it is made. And the body is then one built afresh.
#pragma once

#include "lobe/sim/rebuild.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "strokes.h"
#include "world_support.h"

namespace lobe::test {

template <class Real>
World<Real> moving_world(const Setup& setup, double size = 1e-3) {
  World<Real> world(setup);
  State<Real> state = world.state();
  state.u = random_displacement<Real>(setup.mesh.vertex_count(), size);
  state.v = random_displacement<Real>(setup.mesh.vertex_count(), 0.1, 8);
  world.set_state(state);
  return world;
}

// Sums over the copies of each vertex at the start.
inline Eigen::MatrixXd at_origins(const World<double>& world, const Eigen::MatrixXd& values) {
  const Topology& topology = world.elements().topology;
  Eigen::MatrixXd sums =
      Eigen::MatrixXd::Zero(values.rows(), topology.vertex_count() - topology.copy_count());
  for (Index v = 0; v < topology.vertex_count(); ++v) sums.col(topology.origin(v)) += values.col(v);
  return sums;
}

struct Whole {
  double elastic, kinetic;
  Vec3d momentum, angular_momentum;
  Eigen::MatrixXd masses, forces;  // per vertex at the start
};

inline Whole whole_of(World<double>& world) {
  const Energies e = world.energies();
  Whole whole{e.elastic_linear + e.elastic_nonlinear, e.kinetic, Vec3d::Zero(), Vec3d::Zero(), {}, {}};
  const StateView<double> state = world.state();
  const std::vector<double>& mass = world.body().inertia.mass();
  for (Index v = 0; v < world.elements().topology.vertex_count(); ++v) {
    const Vec3d p = mass[std::size_t(v)] * state.v.col(v);
    whole.momentum += p;
    whole.angular_momentum += Vec3d(world.elements().points.col(v) + state.u.col(v)).cross(p);
  }
  whole.masses = at_origins(world, Eigen::RowVectorXd::Map(mass.data(), Eigen::Index(mass.size())));
  whole.forces = at_origins(world, world.forces());
  return whole;
}

inline void check_nearly_equal(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected) {
  CHECK((found - expected).norm() < 1e-12 * expected.norm());
}

inline void check_that_motion_is_the_same(const Whole& after, const Whole& before) {
  CHECK(after.kinetic == near(before.kinetic, 1e-12));
  check_nearly_equal(after.masses, before.masses);
  check_nearly_equal(after.momentum, before.momentum);
  check_nearly_equal(after.angular_momentum, before.angular_momentum);
}

// Also in a second state, in which copies of a vertex are where it would be: so their stiffness is the same.
inline void check_that_a_cut_changes_nothing_at_once(Setup setup) {
  setup.cut_step = 0;
  World<double> world = moving_world<double>(setup), whole = moving_world<double>(setup);
  const Whole before = whole_of(world);
  cut(world, incisions_of(setup.mesh, 3));
  CHECK(world.elements().topology.tet_copy_count() > 50);
  const Whole after = whole_of(world);
  check_that_motion_is_the_same(after, before);
  CHECK(after.elastic == near(before.elastic, 1e-12));
  check_nearly_equal(after.forces, before.forces);
  State<double> other = whole.state(), of_copies = world.state();
  other.u = random_displacement<double>(setup.mesh.vertex_count(), 2e-3, 21);
  for (Index v = 0; v < world.elements().topology.vertex_count(); ++v)
    of_copies.u.col(v) = other.u.col(world.elements().topology.origin(v));
  whole.set_state(other);
  world.set_state(of_copies);
  check_nearly_equal(at_origins(world, world.forces()), whole.forces());
}

inline void check_that_it_equals_one_built_afresh(const Setup& setup) {
  World<double> world = moving_world<double>(setup);
  cut(world, incisions_of(setup.mesh, 3));
  validate(world);
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
  check_connections(world);
  std::vector<Index> tets;
  for (Index t = 0; t < world.elements().topology.tet_count(); t += 9) tets.push_back(t);
  world.remove_tets(tets);
  validate(world);
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
  check_connections(world);
  if (any_smoothed(setup.materials)) return;  // a tensor-mass region has plain tetrahedra only
  std::vector<Index> others;
  for (Index t = 1; t < world.elements().topology.tet_count(); t += 5)
    if (world.elements().topology.alive(t)) others.push_back(t);
  world.apply(SetRegion{others, RegionModel::tensor_mass});
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
  check_connections(world);
}

}  // namespace lobe::test
