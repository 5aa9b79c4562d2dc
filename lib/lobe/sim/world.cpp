#include "lobe/sim/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>
#include <utility>

#include "lobe/condense/anchors.h"
#include "lobe/error.h"
#include "lobe/numerics/supernodal_factor.h"
#include "lobe/setup/check_setup.h"
#include "lobe/sim/checkpoint.h"

namespace lobe {
namespace {

double mean_edge(const Elements& elements) {
  double sum = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Mat34<double> x = elements.corner_points(t);
    for (const auto& edge : edge_corners) sum += (x.col(edge[0]) - x.col(edge[1])).norm();
  }
  return sum / (6.0 * elements.topology.tet_count());
}

// In which the slowest shear wave crosses the body 16 times [s]: so long a tangle may take to come undone by itself.
double patience_with(const Elements& elements, double diagonal) {
  double slowest = std::numeric_limits<double>::infinity();  // [m²/s²]
  for (const Elastic& e : elements.materials) slowest = std::min(slowest, e.mu / e.density);
  return 16 * diagonal / std::sqrt(slowest);
}

double diagonal(const Elements& elements) {  // of the bounding box [m]
  const auto points = elements.points.view();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

template <class Real>
void check_precision(const Setup& setup) {
  if (setup.integrator == Integrator::generalised_alpha && !std::is_same_v<Real, double>)
    throw InputError("setup", "the implicit integrator needs double precision");
}

}  // namespace

const char* name(Condition::Kind kind) {
  switch (kind) {
    case Condition::Kind::diverged:
      return "diverged";
    case Condition::Kind::too_stiff:
      return "too_stiff";
    case Condition::Kind::sub_stepped:
      return "sub_stepped";
    case Condition::Kind::near_inversion:
      return "near_inversion";
    case Condition::Kind::pieces:
      return "pieces";
    case Condition::Kind::everything_cut:
      return "everything_cut";
    case Condition::Kind::cache:
      return "cache";
    case Condition::Kind::unravelling:
      return "unravelling";
  }
  return "";
}

template <class Real>
World<Real>::World(const Setup& setup, int threads, const CondensingLog::Progress& condensing)
    : setup_((check_setup(setup), check_precision<Real>(setup), setup)),
      fingerprint_(fingerprint(setup)),
      elements_(setup),
      precomputed_(CondensedCache(setup.condensed_cache, condensing), make_supernodal),
      nonlinear_(setup.evaluator),
      expanded_(setup.evaluator),
      loads_(elements_, setup.face_loads, setup.vertex_loads),
      tools_(setup),
      mass_degree_(setup.selective_mass),
      parallel_(threads) {
  setup_.mesh = {};
  setup_.material_of = {};
  const Index n = elements_.topology.vertex_count();
  state_.u = state_.v = Columns(n);
  longest_move_ = mean_edge(elements_);
  const double size = diagonal(elements_);
  sleep_ = Sleep(setup.sleep / 8 * longest_move_ / size);
  patience_ = patience_with(elements_, size);
  held_ = held_by(setup.prescribed);
  RegionEdit everything;
  everything.entered.resize(std::size_t(elements_.topology.tet_count()));
  std::iota(everything.entered.begin(), everything.entered.end(), 0);
  everything.vertices.resize(std::size_t(n));
  std::iota(everything.vertices.begin(), everything.vertices.end(), 0);
  refuse_unanchored(elements_, held_);
  follow(everything);
  find_bodies();
  if (setup.integrator == Integrator::generalised_alpha)
    implicit_ = std::make_unique<ImplicitStep>(setup.spectral_radius, make_ldlt);
  if (setup.expandable && precomputed_.tet_count() > 0) {
    set_expanded(true);
    measure_degrees_at_rest();
    set_expanded(false);
  }
  measure_degrees_at_rest();
  if (setup.mass_scaling > 0) scale_masses();
}

// ---- Stepping

template <class Real>
bool World<Real>::step(double dt) {
  if (implicit_) return implicit_step(dt);
  forces();
  integrate(dt);
  return true;
}

template <class Real>
void World<Real>::integrate(double dt) {
  leave_out_held();
  update_sleep();
  const Fastest<Real> fastest = push(state_.behind + dt / 2, dt);
  fastest_ = std::sqrt(double(fastest.all));
  turned_ = std::sqrt(double(fastest.turned));
  interior_ = Interior::stale;
  state_.time += dt;
  state_.behind = dt / 2;
  ratios_.step();
  move_held(dt);
  if (!moving_.empty() || fastest_held_ > 0) known_ = Known::stale;
  groups_.moved((fastest_ + fastest_held_) * dt, std::numeric_limits<Real>::epsilon());
}

// Held components of who moves along the others stay where they are until move_held().
template <class Real>
void World<Real>::leave_out_held() {
  if (moving_is_stale_) find_moving();
  for (const HeldVertices::Held& item : led_) {
    if (held_.fixes(item.vertex)) continue;  // it is none that moves by itself
    for (int i = 0; i < 3; ++i)
      if (item.axes[i]) forces_(i, item.vertex) = state_.v(i, item.vertex) = 0;
  }
}

// By the forces that were found last, which it leaves changed.
template <class Real>
Fastest<Real> World<Real>::push(double kick, double dt) {
  if (selective_mass_.degree() > 1) {
    find_inertia();
    selective_mass_.apply(led_, parallel_, forces_.padded());
  }
  return central_difference(forces_.padded(), moving_, Real(kick), Real(dt), Real(setup_.damping),
                            state_.u.padded(), state_.v.padded(), turns_, parallel_);
}

// Brings velocities up to the time of the displacements, before an edit makes the forces jump: those from before it act
// until then, those after it from then on.
template <class Real>
void World<Real>::catch_up() {
  if (implicit_ || state_.behind == 0) return;
  forces();
  leave_out_held();
  push(std::exchange(state_.behind, 0), 0);
  interior_ = Interior::stale;
}

// What rests is put in its place here, and needs nothing from a step.
template <class Real>
void World<Real>::find_moving() {
  moving_ = moving_vertices<Real>(inverse_mass_);
  std::erase_if(moving_, [&](const MovingVertex<Real>& own) { return sleep_.is_asleep(own.vertex); });
  led_.clear();
  for (const HeldVertices::Held& item : held_.all()) {
    if (item.holder != HeldVertices::boundary || item.start != item.goal || item.axes != all_axes) {
      led_.push_back(item);
      continue;
    }
    state_.u.col(item.vertex) = item.goal.template cast<Real>();
    state_.v.col(item.vertex).setZero();
  }
  moving_is_stale_ = false;
  arrangement_is_stale_ = true;
}

template <class Real>
double World<Real>::missing_loads(double time) const {
  return setup_.load_ramp > 0 ? std::max(0.0, 1 - time / setup_.load_ramp) : 0;
}

template <class Real>
Eigen::Map<const Mat3X<Real>> World<Real>::forces() {
  put_loads();
  if (!is_expanded_)
    precomputed_.add_forces(state_.u.padded(), Real(missing_loads(state_.time)), forces_.padded(), parallel_);
  add_internal_forces(state_.u.padded(), forces_.padded());
  return std::as_const(forces_).view();
}

template <class Real>
void World<Real>::add_internal_forces(const Mat3X<Real>& u, Mat3X<Real>& f) {
  tensor_mass_.add_forces(u, f, parallel_);
  nonlinear_.add_forces(u, f, parallel_);
  if (is_expanded_) expanded_.add_forces(u, f, parallel_);
}

template <class Real>
double World<Real>::ramp_at(double time) const {
  return setup_.ramp > 0 ? std::clamp(time / setup_.ramp, 0.0, 1.0) : 1.0;
}

template <class Real>
Vec3d World<Real>::held_displacement(const HeldVertices::Held& item, double time, double ramp) const {
  if (item.holder != HeldVertices::boundary) return tools_.grasped(item, time);
  return item.start + ramp * (item.goal - item.start);
}

template <class Real>
void World<Real>::move_held(double dt) {
  fastest_held_ = 0;
  std::vector<Index> moved;
  const double ramp = ramp_at(state_.time);
  for (const HeldVertices::Held& item : led_) {
    const Vec3<Real> u = held_displacement(item, state_.time, ramp).template cast<Real>();
    for (int i = 0; i < 3; ++i) {
      if (!item.axes[i]) continue;
      state_.v(i, item.vertex) = (u[i] - state_.u(i, item.vertex)) / Real(dt);
      state_.u(i, item.vertex) = u[i];
    }
    const double speed = double(state_.v.col(item.vertex).squaredNorm());
    fastest_held_ = std::max(fastest_held_, speed);
    if (speed > 0 && sleep_.is_asleep(item.vertex)) moved.push_back(item.vertex);
  }
  if (!moved.empty()) wake(moved);
  fastest_held_ = std::sqrt(fastest_held_);
}

// The accelerations of generalised-α are taken from the forces after every edit.
template <class Real>
bool World<Real>::implicit_step(double dt) {
  if constexpr (std::is_same_v<Real, double>) {
    if (implicit_is_stale_ || !implicit_->is_built_on(elements_)) implicit_->rebuild(elements_, held_);
    if (implicit_is_stale_) {
      acceleration_ = -setup_.damping * state_.v.view();
      forces();
      for (Index v = 0; v < forces_.count(); ++v) acceleration_.col(v) += inverse_mass_[v] * forces_.col(v);
      implicit_is_stale_ = false;
    }
    const double load_time = state_.time + implicit_->load_time() * dt;
    StepLoads loads{mass_, external_.view() - missing_loads(load_time) * dead_loads_.view(), state_.u.view(),
                    setup_.damping};
    const double ramp = ramp_at(state_.time + dt);
    for (const HeldVertices::Held& item : held_.all()) {
      const Vec3d u = held_displacement(item, state_.time + dt, ramp);
      for (int i = 0; i < 3; ++i)
        if (item.axes[i]) loads.given(i, item.vertex) = u[i];
    }
    Motion motion{state_.u.view(), state_.v.view(), acceleration_};
    if (!implicit_->step(loads, dt, motion)) return false;
    known_ = Known::stale;
    groups_.moved((motion.u - state_.u.view()).colwise().norm().maxCoeff(),
                  std::numeric_limits<double>::epsilon());
    state_.u.view() = motion.u;
    state_.v.view() = motion.v;
    acceleration_ = motion.a;
    state_.time += dt;
    return true;
  }
  return false;
}

template <class Real>
void World<Real>::set_state(const State<Real>& state) {
  if (state.u.cols() != state_.u.count() || state.v.cols() != state_.v.count())
    throw InputError("state",
                     "it must have one column per vertex of the world, " + std::to_string(state_.u.count()));
  if (!state.u.allFinite() || !state.v.allFinite())
    throw InputError("state", "it holds values that are not finite");
  if (!(state.behind >= 0) || !std::isfinite(state.behind))
    throw InputError("state", "its velocities must be behind by 0 s or more");
  state_.u.view() = state.u;
  state_.v.view() = state.v;
  state_.time = state.time;
  state_.behind = state.behind;
  implicit_is_stale_ = moving_is_stale_ = kept_is_stale_ = true;
  interior_ = Interior::stale;
  sleep_.wake_all(state.time);
  ratios_.forget_all(at_rest().ratio);
  unravelling_.stage = 0;
  unravelling_.since = state.time;
  known_ = Known::stale;
  groups_.forget();
}

// ---- What can be asked

template <class Real>
StateView<Real> World<Real>::state() const {
  if (interior_ != Interior::all && !is_expanded_)
    precomputed_.recover(elements_, Real(missing_loads(state_.time)), state_.u.padded(), &state_.v.padded());
  interior_ = Interior::all;
  const Moving& moving = state_;
  return {moving.u.view(), moving.v.view(), moving.time, moving.behind};
}

template <class Real>
Eigen::Map<const Mat3X<Real>> World<Real>::displacements() const {
  if (interior_ == Interior::stale && !is_expanded_) {
    precomputed_.recover(elements_, Real(missing_loads(state_.time)), state_.u.padded(), nullptr);
    interior_ = Interior::displacements;
  }
  return std::as_const(state_).u.view();
}

template <class Real>
Vec3d World<Real>::reaction(int holder) {
  forces();
  state();
  Vec3d sum = Vec3d::Zero();
  for (const HeldVertices::Held& item : held_.all()) {
    if (item.holder != holder) continue;
    const Vec3d inside =
        is_expanded_ ? Vec3d::Zero() : precomputed_.force_on_fixed(elements_, state_.u.padded(), item.vertex);
    for (int i = 0; i < 3; ++i)
      if (item.axes[i]) sum[i] -= double(forces_(i, item.vertex)) + inside[i];
  }
  return sum;
}

template <class Real>
Energies World<Real>::energies() {
  state();
  Energies e;
  e.kinetic = kinetic_energy();
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v)
    e.loads -= external_.col(v).template cast<double>().dot(state_.u.col(v).template cast<double>());
  e.elastic_linear = tensor_mass_.energy(state_.u.padded());
  e.elastic_nonlinear = nonlinear_.energy(state_.u.padded());
  if (is_expanded_) {
    e.elastic_nonlinear += expanded_.energy(state_.u.padded());
  } else {
    const auto precomputed = precomputed_.energy(elements_, state_.u.padded());
    e.loads += precomputed.loads;
    e.elastic_linear += precomputed.elastic;
  }
  return e;
}

template <class Real>
std::vector<Tools::Pose> World<Real>::tool_poses() const {
  return tools_.poses(state_.time, held_, [&](Index v) -> Vec3d {
    return elements_.points.col(v) + state().u.col(v).template cast<double>();
  });
}

template class World<float>;
template class World<double>;

}  // namespace lobe
