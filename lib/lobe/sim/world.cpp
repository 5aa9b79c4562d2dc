#include "lobe/sim/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>

#include "lobe/condense/supports.h"
#include "lobe/error.h"
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

double diagonal(const Elements& elements) {  // of the bounding box [m]
  const auto points = elements.points.view();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

RegionEdit everything(const Topology& topology) {
  RegionEdit edit;
  edit.entered.resize(std::size_t(topology.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  edit.vertices.resize(std::size_t(topology.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  return edit;
}

template <class Real>
const Setup& checked(const Setup& setup) {
  check_setup(setup, std::is_same_v<Real, float> ? Options{Option::single_precision} : Options{});
  return setup;
}

}  // namespace

template <class Real>
World<Real>::World(const Setup& setup, int threads, const CondensingLog::Progress& condensing)
    : setup_(checked<Real>(setup)),
      journal_{lobe::fingerprint(setup), {}},
      body_(setup, threads, condensing),
      limit_(mean_edge(elements())),
      unravelling_(elements(), diagonal(elements())),
      tools_(setup) {
  setup_.mesh = {};
  setup_.material_of = {};
  body_.motion.longest_move = mean_edge(elements());
  body_.sleep = Sleep(setup.sleep, setup.sleep / 8 * body_.motion.longest_move / diagonal(elements()));
  if (setup.cut_frequency > 0)
    body_.inertia.set_floor({setup.cut_frequency * setup.cut_frequency, setup.expandable});
  refuse_unsupported(elements(), held());
  follow(everything(elements().topology));
  pieces_ = Pieces(body_.model);
  if (setup.integrator == Integrator::generalised_alpha)
    implicit_ = std::make_unique<ImplicitDynamics>(setup.spectral_radius);
  if (body_.regions.can_be_expanded()) {
    set_expanded(true);
    limit_.measure_at_rest(body_);
    set_expanded(false);
  }
  limit_.measure_at_rest(body_);
  embed();
  if (setup.mass_scaling > 0) scale_masses(setup.mass_scaling);
  if (!setup.scalpels.empty()) prepare_blades();
}

template <class Real>
void World<Real>::scale_masses(double share) {
  MassScaling& scaling = body_.inertia.scaling();
  scaling.limit_before = time_step_limit();
  const std::vector<double>& mass = body_.inertia.mass();
  std::vector<Index> all(mass.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> squares;
  for (Index v : all) squares.push_back(limit_.exact_square(body_, v));
  const double total = std::accumulate(mass.begin(), mass.end(), 0.0);
  body_.inertia.scale(squares, share);
  update_vertices(all);
  scaling.added = std::accumulate(mass.begin(), mass.end(), 0.0) - total;
  scaling.share = scaling.added / total;
  limit_.measure_at_rest(body_);
  scaling.limit_after = time_step_limit();
}

// ---- Steps

// Moves the body by one step with the forces that were found at its start.
template <class Real>
void World<Real>::move(double dt) {
  Motion<Real>& motion = body_.motion;
  add_tool_forces(dt);
  body_.restore_held_components();
  body_.sleep.update(body_, [&](Index v) { return limit_.bounded_square(v); });
  body_.push(motion.velocity_lag + dt / 2, dt);
  motion.velocity_lag = dt / 2;
  motion.time += dt;
  move_driven(dt);
  end_step(dt);
}

// Tells what follows the motion how far it went.
template <class Real>
void World<Real>::end_step(double dt) {
  const Motion<Real>& motion = body_.motion;
  limit_.count_step();
  const bool any_moving = !body_.inertia.moving().empty() || body_.regions.any_moving_nodes();
  if (any_moving || motion.speeds.driven > 0) ++body_.model.revisions.displacements;
  const double farthest = (motion.speeds.fastest + motion.speeds.driven) * dt;
  tools_.moved(farthest, std::numeric_limits<Real>::epsilon());
  for (const auto& term : body_.terms) term->end_step(farthest, dt);
}

// Adds the forces of this step on tools. A grasp bears the forces on the vertices that it holds.
template <class Real>
void World<Real>::add_tool_forces(double dt) {
  const Motion<Real>& motion = body_.motion;
  for (const HeldVertices::Held& item : held().all()) {
    if (item.holder == HeldVertices::boundary) continue;
    const Vec3d x = elements().points.col(item.vertex) + motion.u.col(item.vertex).template cast<double>();
    Vec3d force = -motion.forces.col(item.vertex).template cast<double>();
    for (int i = 0; i < 3; ++i)
      if (!item.axes[i]) force[i] = 0;
    tools_.add_force(item.holder, force, x, dt);
  }
  for (const auto& term : body_.terms)
    for (const OnTool& on_tool : term->on_tools()) tools_.add_force(on_tool, dt);
}

// Moves held vertices to where boundary conditions and grasps prescribe.
template <class Real>
void World<Real>::move_driven(double dt) {
  Motion<Real>& motion = body_.motion;
  double fastest = 0;
  std::vector<Index> woken;
  tools_.place(motion.time);
  for (const HeldVertices::Held& item : body_.inertia.driven()) {
    const Vec3<Real> u = prescribed_displacement(item, motion.time).template cast<Real>();
    for (int i = 0; i < 3; ++i) {
      if (!item.axes[i]) continue;
      motion.v(i, item.vertex) = (u[i] - motion.u(i, item.vertex)) / Real(dt);
      motion.u(i, item.vertex) = u[i];
    }
    const double speed = double(motion.v.col(item.vertex).squaredNorm());
    fastest = std::max(fastest, speed);
    if (speed > 0 && body_.sleep.is_asleep(item.vertex)) woken.push_back(item.vertex);
  }
  if (!woken.empty()) body_.sleep.wake(woken, body_);
  motion.speeds.driven = std::sqrt(fastest);
}

template <class Real>
Vec3d World<Real>::prescribed_displacement(const HeldVertices::Held& item, double time) const {
  if (item.holder != HeldVertices::boundary)
    return tools_.displacement(item, elements().points.col(item.vertex));
  const double ramp = setup_.ramp > 0 ? std::clamp(time / setup_.ramp, 0.0, 1.0) : 1.0;
  return item.start + ramp * (item.goal - item.start);
}

template <class Real>
bool World<Real>::implicit_step(double dt) {
  if constexpr (std::is_same_v<Real, double>) {
    tools_.place(time() + dt);
    const auto given = [&](const HeldVertices::Held& item, double time) {
      return prescribed_displacement(item, time);
    };
    if (!implicit_->step(body_, dt, given)) return false;
    tools_.moved(body_.motion.speeds.fastest * dt, std::numeric_limits<double>::epsilon());
    const auto is_grasped = [](const HeldVertices::Held& item) {
      return item.holder != HeldVertices::boundary;
    };
    if (std::any_of(held().all().begin(), held().all().end(), is_grasped)) {
      body_.find_forces();
      add_tool_forces(dt);
    }
    return true;
  }
  return false;
}

template <class Real>
void World<Real>::synchronise_velocities() {
  if (implicit_ || body_.motion.velocity_lag == 0) return;
  refresh_terms();
  body_.synchronise_velocities();
}

// ---- State

template <class Real>
StateView<Real> World<Real>::state() {
  body_.recover(Regions<Real>::Interior::all);
  const Motion<Real>& motion = body_.motion;
  return {motion.u.view(), motion.v.view(), motion.time, motion.velocity_lag};
}

template <class Real>
Eigen::Map<const Mat3X<Real>> World<Real>::displacements() {
  body_.recover(Regions<Real>::Interior::displacements);
  return std::as_const(body_.motion.u).view();
}

template <class Real>
Eigen::Map<const Mat3X<Real>> World<Real>::forces() {
  refresh_terms();
  body_.find_forces();
  return std::as_const(body_.motion.forces).view();
}

template <class Real>
void World<Real>::check(const State<Real>& state) {
  if (!state.u.allFinite() || !state.v.allFinite() || !std::isfinite(state.time))
    throw InputError("state", "it holds values that are not finite");
  if (!(state.velocity_lag >= 0) || !std::isfinite(state.velocity_lag))
    throw InputError("state", "its velocities must be older than its displacements by 0 s or more");
}

template <class Real>
void World<Real>::set_state(const State<Real>& state) {
  check(state);
  if (state.u.cols() != body_.motion.u.count() || state.v.cols() != body_.motion.v.count())
    throw InputError("state", "it must have one column per vertex of the world, " +
                                  std::to_string(body_.motion.u.count()));
  Motion<Real>& motion = body_.motion;
  motion.u.view() = state.u;
  motion.v.view() = state.v;
  motion.time = state.time;
  motion.velocity_lag = implicit_ ? 0 : state.velocity_lag;
  body_.regions.settle(elements(), limit_.highest_at_rest(), motion);
  body_.state_was_replaced();
  body_.sleep.wake_all(state.time);
  limit_.restart(body_);
  unravelling_.restart(state.time);
}

template <class Real>
std::vector<PlacedTool> placed_tools(World<Real>& world) {
  const auto u = world.displacements();
  return world.tools().placed(world.time(), world.held(), [&](Index v) -> Vec3d {
    return world.elements().points.col(v) + u.col(v).template cast<double>();
  });
}

// ---- For observers

template <class Real>
void World<Real>::publish(const Report& report) {
  surface();
  display_.publish(elements(), state(), placed_tools(*this), report);
}

template std::vector<PlacedTool> placed_tools(World<float>&);
template std::vector<PlacedTool> placed_tools(World<double>&);
template class World<float>;
template class World<double>;

}  // namespace lobe
