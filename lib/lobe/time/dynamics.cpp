#include "lobe/time/dynamics.h"

#include <cmath>
#include <utility>

namespace lobe {
namespace {

template <class Terms, class Vertices>
std::vector<Index> of_all(const Terms& terms, Vertices&& vertices_of) {
  std::vector<Index> all;
  for (const auto& term : terms) {
    const std::vector<Index> vertices = vertices_of(term);
    all.insert(all.end(), vertices.begin(), vertices.end());
  }
  return all;
}

}  // namespace

template <class Real>
Dynamics<Real>::Dynamics(const Setup& setup, int threads, const Progress& progress)
    : model{Elements(setup), held_by(setup), {}},
      regions(setup, progress),
      loads(model.elements, setup),
      inertia(setup),
      parallel(threads),
      damping(setup.damping) {
  motion.extend(model.elements.topology.vertex_count());
}

template <class Real>
void Dynamics<Real>::find_forces(const Kick& kick, const ViscousStep& step) {
  if (kick.dt > 0 && any_own_steps()) return find_forces_of_own_steps(kick, false);
  if (const std::vector<Index>* wanted = sleep.begin_forces(*this))
    loads.put_at(*wanted, motion.forces);
  else
    loads.put(motion.time, parallel, motion.forces);
  regions.begin_forces(!terms.empty(), motion, parallel);
  regions.add_forces(motion.u.padded(), loads.missing_share(motion.time), step, motion.forces.padded(),
                     parallel);
  for (const auto& term : terms) term->add_forces(here(kick), motion.forces.padded());
  regions.end_forces(loads.missing_share(motion.time), motion, parallel);
}

template <class Real>
void Dynamics<Real>::find_forces_of_own_steps(const Kick& kick, bool all) {
  own_steps->begin_forces(*this, all);
  regions.add_forces(motion.u.padded(), loads.missing_share(motion.time), {}, motion.forces.padded(),
                     parallel);
  for (const auto& term : terms) term->add_forces(here(kick), motion.forces.padded());
  own_steps->end_forces(*this);
}

template <class Real>
void Dynamics<Real>::recover(typename Regions<Real>::Interior wanted) {
  regions.recover(model, loads.missing_share(motion.time), wanted, motion);
}

template <class Real>
void Dynamics<Real>::recover_followers() {
  if (regions.any_following()) recover(Regions<Real>::Interior::all);
}

template <class Real>
void Dynamics<Real>::find_moving() {
  inertia.find_moving(
      model, sleep.revision(), [&](Index v) { return sleep.is_asleep(v); }, motion);
}

template <class Real>
void Dynamics<Real>::prepare_inertia() {
  find_moving();
  inertia.prepare(model, sleep.any(), [&](Index t) { return regions.is_dynamic(model.elements, t); });
}

template <class Real>
Energies Dynamics<Real>::energies() {
  Energies e = energies_without_terms();
  for (const auto& term : terms) e.applied += term->energy(here());
  e.applied += hold_springs.energy(motion.u.padded());
  return e;
}

template <class Real>
Energies Dynamics<Real>::energies_without_terms() {
  recover(Regions<Real>::Interior::all);
  if (inertia.is_selective()) prepare_inertia();
  const ElasticEnergy elastic = regions.energy(model.elements, motion);
  Energies e;
  e.kinetic = inertia.kinetic_energy(motion, parallel) + regions.kinetic_energy(motion);
  e.elastic_linear = elastic.linear;
  e.elastic_nonlinear = elastic.nonlinear;
  e.loads = elastic.loads - loads.work(motion.u.padded());
  return e;
}

template <class Real>
std::vector<Index> Dynamics<Real>::acted_on_by_terms() const {
  return of_all(terms, [&](const auto& term) { return term->acts_on(model); });
}

template <class Real>
std::vector<Index> Dynamics<Real>::woken_by_terms() const {
  return of_all(terms, [&](const auto& term) { return term->wakes(model); });
}

template <class Real>
Vec3d Dynamics<Real>::reaction(int holder) {
  recover(Regions<Real>::Interior::all);
  find_forces();
  Vec3d sum = Vec3d::Zero();
  for (const HeldVertices::Held& item : model.held.all()) {
    if (item.holder != holder) continue;
    const Vec3d inside = regions.force_on_fixed(model.elements, motion.u.padded(), item.vertex);
    for (int i = 0; i < 3; ++i)
      if (item.axes[i]) sum[i] -= double(motion.forces(i, item.vertex)) + inside[i];
  }
  for (const auto& spring : hold_springs.all())
    if (spring.item.holder == holder) sum += hold_springs.force_now(spring, motion.u.padded());
  return sum;
}

template <class Real>
void Dynamics<Real>::restore_held_components() {
  find_moving();
  for (const HeldVertices::Held& item : inertia.driven()) {
    if (model.held.fixes(item.vertex)) continue;  // no component of it moves by itself
    for (int i = 0; i < 3; ++i)
      if (item.axes[i]) motion.forces(i, item.vertex) = motion.v(i, item.vertex) = 0;
  }
}

template <class Real>
void Dynamics<Real>::push(double kick, double dt) {
  if (hold_springs.any()) {  // a push without a step ends the last one, of which `kick` is half
    const double step = dt > 0 ? dt : 2 * kick;
    hold_springs.apply(inertia.inverse_mass(), step, motion.u.padded(), motion.forces.padded());
  }
  if (inertia.is_selective()) {
    prepare_inertia();
    inertia.apply(parallel, motion.forces.padded());
  }
  Fastest<Real> fastest =
      any_own_steps()
          ? own_steps->push(*this, kick, dt)
          : central_difference(motion.forces.padded(), inertia.moving(), Real(kick), Real(dt), Real(damping),
                               motion.u.padded(), motion.v.padded(), motion.reversals, parallel);
  if (regions.any_moving_nodes()) {
    const Fastest<Real> nodes = regions.push(kick, dt, damping, motion, parallel);
    fastest = {std::max(fastest.all, nodes.all), std::max(fastest.reversing, nodes.reversing)};
  }
  motion.speeds.fastest = std::sqrt(double(fastest.all));
  motion.speeds.reversing = std::sqrt(double(fastest.reversing));
  ++model.revisions.velocities;
}

template <class Real>
void Dynamics<Real>::end_step() {
  const bool any_moving = !inertia.moving().empty() || regions.any_moving_nodes();
  if (any_moving || motion.speeds.driven > 0) ++model.revisions.displacements;
}

template <class Real>
void Dynamics<Real>::synchronise_velocities() {
  if (motion.velocity_lag == 0) return;
  if (any_own_steps())
    find_forces_of_own_steps({}, true);
  else
    find_forces({}, {.before = motion.velocity_lag, .follows = true});
  restore_held_components();
  push(std::exchange(motion.velocity_lag, 0), 0);
}

template <class Real>
void Dynamics<Real>::state_has_moved() {
  ++model.revisions.displacements;
  ++model.revisions.velocities;
}

template <class Real>
void Dynamics<Real>::state_was_replaced() {
  state_has_moved();
  ++model.revisions.jumps;
  ++model.revisions.replaced;
}

template struct Dynamics<float>;
template struct Dynamics<double>;

}  // namespace lobe
