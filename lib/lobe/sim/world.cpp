#include "lobe/sim/world.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>

#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"

namespace lobe {
namespace {

// ---- Commands of tools

template <class Real, class Bring>
requires requires { &Bring::check; }
void perform(Tools& tools, Organ<Real>& organ, const Bring& command) {
  command.check(organ.elements().topology.vertex_count(), options_of(organ.setup()));
  tools.bring(command);
  if constexpr (Bring::needs_grains) organ.prepare_blades();
}
template <class Real>
void perform(Tools& tools, Organ<Real>&, const Lead& command) {
  tools.lead(command.tool, command.target);
}
template <class Real>
void perform(Tools& tools, Organ<Real>&, const SwitchTool& command) {
  tools.turn_on(command.tool, command.on);
}
template <class Real>
void perform(Tools& tools, Organ<Real>&, const LetGo& command) {
  tools.let_go(command.tool);
}

// Adds the forces of a step on tools. A grasp bears the forces on the vertices that it holds.
template <class Real>
void add_tool_forces(const Dynamics<Real>& body, double dt, Tools& tools) {
  const Motion<Real>& motion = body.motion;
  for (const HeldVertices::Held& item : body.model.held.all()) {
    if (item.holder == HeldVertices::boundary) continue;
    const Vec3d x =
        body.model.elements.points.col(item.vertex) + motion.u.col(item.vertex).template cast<double>();
    Vec3d force = -motion.forces.col(item.vertex).template cast<double>();
    for (int i = 0; i < 3; ++i)
      if (!item.axes[i]) force[i] = 0;
    tools.add_force(item.holder, force, x, dt);
  }
  for (const auto& term : body.terms)
    for (const OnTool& on_tool : term->on_tools()) tools.add_force(on_tool, dt);
}

// The same of the springs by which it holds a part of a vertex.
template <class Real>
void add_forces_of_springs(const Dynamics<Real>& body, double dt, Tools& tools) {
  for (const auto& spring : body.hold_springs.all()) {
    if (spring.item.holder == HeldVertices::boundary) continue;
    const Index v = spring.item.vertex;
    const Vec3d x = body.model.elements.points.col(v) + body.motion.u.col(v).template cast<double>();
    tools.add_force(spring.item.holder, spring.force, x, dt);
  }
}

}  // namespace

template <class Real>
World<Real>::World(const Setup& setup, int threads, const Progress& progress)
    : organ_(setup, threads, progress), tools_(setup) {}

template <class Real>
void World<Real>::apply(const Command& command) {
  std::visit(
      [this]<class Any>(const Any& any) {
        if constexpr (std::is_constructible_v<Edit, Any>)
          organ_.perform(any);
        else if constexpr (std::is_same_v<Advance, Any>)
          advance(any.duration);
        else
          perform(tools_, organ_, any);
      },
      command);
  if constexpr (is_debug_build) validate(*this);
}

// ---- Steps

// Moves the body by one step with the forces that were found at its start.
template <class Real>
void World<Real>::move(double dt) {
  Motion<Real>& motion = body().motion;
  aim_hold_springs();
  add_tool_forces(body(), dt, tools_);
  body().restore_held_components();
  body().sleep.update(body());
  body().push(motion.velocity_lag + dt / 2, dt);
  add_forces_of_springs(body(), dt, tools_);
  motion.velocity_lag = dt / 2;
  motion.time += dt;
  move_driven(dt);
  organ_.end_step(dt);
}

template <class Real>
void World<Real>::aim_hold_springs() {
  if (held().partly().empty() && !body().hold_springs.any()) return;
  tools_.place(time());
  body().aim_hold_springs(
      [&](const HeldVertices::Held& item) { return prescribed_displacement(item, time()); });
}

// Moves held vertices to where boundary conditions and grasps prescribe.
template <class Real>
void World<Real>::move_driven(double dt) {
  Motion<Real>& motion = body().motion;
  double fastest = 0;
  std::vector<Index> woken;
  tools_.place(motion.time);
  for (const HeldVertices::Held& item : body().inertia.driven()) {
    const Vec3<Real> u = prescribed_displacement(item, motion.time).template cast<Real>();
    for (int i = 0; i < 3; ++i) {
      if (!item.axes[i]) continue;
      motion.v(i, item.vertex) = (u[i] - motion.u(i, item.vertex)) / Real(dt);
      motion.u(i, item.vertex) = u[i];
    }
    const double speed = double(motion.v.col(item.vertex).squaredNorm());
    fastest = std::max(fastest, speed);
    if (speed > 0 && body().sleep.is_asleep(item.vertex)) woken.push_back(item.vertex);
  }
  if (!woken.empty()) body().sleep.wake(woken, body());
  motion.speeds.driven = std::sqrt(fastest);
  aim_hold_springs();
}

template <class Real>
Vec3d World<Real>::prescribed_displacement(const HeldVertices::Held& item, double time) const {
  if (item.holder != HeldVertices::boundary)
    return tools_.displacement(item, elements().points.col(item.vertex));
  const double ramp = organ_.setup().ramp > 0 ? std::clamp(time / organ_.setup().ramp, 0.0, 1.0) : 1.0;
  return item.start + ramp * (item.goal - item.start);
}

template <class Real>
bool World<Real>::implicit_step(double dt) {
  if constexpr (std::is_same_v<Real, double>) {
    tools_.place(time() + dt);
    const auto given = [&](const HeldVertices::Held& item, double time) {
      return prescribed_displacement(item, time);
    };
    if (!organ_.implicit()->step(body(), dt, given)) return false;
    organ_.moved(body().motion.speeds.fastest * dt, std::numeric_limits<double>::epsilon());
    const auto is_grasped = [](const HeldVertices::Held& item) {
      return item.holder != HeldVertices::boundary;
    };
    if (std::any_of(held().all().begin(), held().all().end(), is_grasped)) {
      body().find_forces();
      add_tool_forces(body(), dt, tools_);
    }
    return true;
  }
  return false;
}

// ---- State

template <class Real>
Eigen::Map<const Mat3X<Real>> World<Real>::forces() {
  organ_.refresh_terms();
  body().find_forces();
  return std::as_const(body().motion.forces).view();
}

template <class Real>
std::vector<PlacedTool> placed_tools(World<Real>& world) {
  const auto u = world.displacements();
  return world.tools().placed(world.time(), world.held(), [&](Index v) -> Vec3d {
    return world.elements().points.col(v) + u.col(v).template cast<double>();
  });
}

template <class Real>
std::vector<ThreadLine> thread_lines(World<Real>& world) {
  Dynamics<Real>& body = world.body();
  const Threads<Real>* threads = term_of<Threads>(body.terms);
  if (!threads) return {};
  body.recover_followers();
  return threads->drawn(body.here());
}

template <class Real>
std::vector<TermLines> term_lines(World<Real>& world) {
  Dynamics<Real>& body = world.body();
  std::vector<TermLines> all;
  if (body.terms.empty()) return all;
  body.recover_followers();
  for (const auto& term : body.terms) {
    std::vector<TermLines> lines = term->lines(body.here());
    std::move(lines.begin(), lines.end(), std::back_inserter(all));
  }
  return all;
}

template <class Real>
std::vector<AttachmentFigures> attachment_figures(World<Real>& world) {
  Dynamics<Real>& body = world.body();
  const Attachments<Real>* attachments = term_of<Attachments>(body.terms);
  if (!attachments) return {};
  body.recover_followers();
  return attachments->figures(body.here());
}

template <class Real>
std::vector<NeedleFigures> needle_figures(World<Real>& world) {
  const Needles<Real>* needles = term_of<Needles>(world.body().terms);
  return needles ? needles->figures() : std::vector<NeedleFigures>{};
}

template <class Real>
std::vector<ClipFigures> clip_figures(World<Real>& world) {
  Dynamics<Real>& body = world.body();
  const Clips<Real>* clips = term_of<Clips>(body.terms);
  if (!clips) return {};
  body.recover_followers();
  return clips->figures(body.here());
}

template <class Real>
std::vector<CarrierFigures> carrier_figures(World<Real>& world) {
  const Clips<Real>* clips = term_of<Clips>(world.body().terms);
  return clips ? clips->carriers() : std::vector<CarrierFigures>{};
}

// ---- For observers

template <class Real>
void World<Real>::publish(const Report& report) {
  surface();
  organ_.display().publish(elements(), state(), placed_tools(*this), term_lines(*this), report);
}

template <class Real>
void incise(World<Real>& world, const std::vector<Incision>& incisions) {
  world.organ_.incise(incisions);
}

template void incise(World<float>&, const std::vector<Incision>&);
template void incise(World<double>&, const std::vector<Incision>&);
template std::vector<PlacedTool> placed_tools(World<float>&);
template std::vector<PlacedTool> placed_tools(World<double>&);
template std::vector<ThreadLine> thread_lines(World<float>&);
template std::vector<ThreadLine> thread_lines(World<double>&);
template std::vector<TermLines> term_lines(World<float>&);
template std::vector<TermLines> term_lines(World<double>&);
template std::vector<AttachmentFigures> attachment_figures(World<float>&);
template std::vector<AttachmentFigures> attachment_figures(World<double>&);
template std::vector<NeedleFigures> needle_figures(World<float>&);
template std::vector<NeedleFigures> needle_figures(World<double>&);
template std::vector<ClipFigures> clip_figures(World<float>&);
template std::vector<ClipFigures> clip_figures(World<double>&);
template std::vector<CarrierFigures> carrier_figures(World<float>&);
template std::vector<CarrierFigures> carrier_figures(World<double>&);
template class World<float>;
template class World<double>;

}  // namespace lobe
