// A frame of a World, and what happens on trouble (theory, section 8).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/error.h"
#include "lobe/sim/validate.h"
#include "lobe/sim/world.h"
#include "lobe/text.h"

namespace lobe {
namespace {

using Clock = std::chrono::steady_clock;

// Adds the wall time of a scope to a phase.
class Timed {
 public:
  Timed(Report& report, Phase phase) : sum_(report.seconds[std::size_t(phase)]), start_(Clock::now()) {}
  ~Timed() { sum_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& sum_;
  Clock::time_point start_;
};

// In a frame in which vertices became full or embedded the limit is that of the new state. What looks like
// trouble there mostly is strained tissue that snaps back, at the highest frequencies, for some steps. So a
// second try has few more steps, enough that no single swing looks so: ω Δt is below √3 even where safety is
// 0.95. It is not checked for swinging, as later tries are not.
constexpr double more_for_snap = 1.15;

Condition near_inversion(double volume_ratio, Index tet, double time) {
  return {Condition::Kind::near_inversion,
          "tetrahedron " + std::to_string(tet) + " is at " + rounded(volume_ratio) + " of its volume" +
              (volume_ratio < 0 ? ", inverted" : "") +
              ": guard_below, a larger volume_penalty, a smaller load or a slower tool may help",
          time};
}

Condition too_stiff(double limit, double time) {
  return {Condition::Kind::too_stiff,
          "the stable step is " + rounded(limit) +
              " s, which makes more than a million steps per frame: use softer materials, a coarser mesh "
              "or a shorter frame",
          time};
}

std::string lost_on_lattice(Index v) {
  return "a force on vertex " + std::to_string(v) +
         ", which follows a lattice, had no effect in a frame: move the tool more slowly, or use shorter "
         "frames";
}

Condition sub_stepped(int tries, int steps, double time) {
  return {Condition::Kind::sub_stepped,
          "it took " + std::to_string(tries) + " tries and " + std::to_string(steps) + " steps", time};
}

Condition diverged(double step, const std::string& fastest, double time) {
  return {
      Condition::Kind::diverged,
      "no step down to " + rounded(step) + " s was stable; " + fastest +
          "the displacements and velocities before it were restored. Use a smaller load or tool speed, more "
          "damping, guard_below or a volume_penalty",
      time};
}

// Driven vertices may be driven to infinity. No force shows that if no free vertex is near.
template <class Real>
bool driven_are_finite(const HeldVertices& held, const StateColumns<Real>& state) {
  return std::all_of(held.all().begin(), held.all().end(), [&](const HeldVertices::Held& item) {
    return state.u.col(item.vertex).allFinite() && state.v.col(item.vertex).allFinite();
  });
}

}  // namespace

template <class Real>
bool World<Real>::step(double dt) {
  begin_frame(dt);
  show_body();
  tools_.begin_forces();
  Report unread;
  if (!take_step(dt, unread)) return false;
  tools_.end_forces(dt);
  return true;
}

// False if an implicit step was not solved.
template <class Real>
bool World<Real>::take_step(double dt, Report& report) {
  if (!implicit_) {
    const Timed timed(report, Phase::forces);
    body_.find_forces();
  }
  const Timed timed(report, Phase::integration);
  if (implicit_ && !implicit_step(dt)) return false;
  if (!implicit_) move(dt);
  ++report.steps;
  return true;
}

// Returns false as soon as a step fails its checks.
template <class Real>
bool World<Real>::run_steps(int steps, double dt, bool first_try, Report& report) {
  body_.sleep.begin_frame();
  tools_.begin_forces();
  for (Reversals* turns : {&body_.motion.reversals, &body_.motion.node_turns})
    std::fill(turns->begin(), turns->end(), 0);
  for (int i = 0; i < steps; ++i) {
    if (!take_step(dt, report)) return false;
    if (!implicit_ && is_in_trouble(dt, first_try)) return false;
  }
  tools_.end_forces(steps * dt);
  return driven_are_finite(held(), body_.motion);
}

// Whether a vertex is not a number or moved further than an edge in one step. In a first try it also checks
// for vertices that swing to and fro, ever faster, by more than a fiftieth of an edge. A body that really has
// such high frequencies looks the same, so later tries skip this check.
template <class Real>
bool World<Real>::is_in_trouble(double dt, bool first_try) const {
  const Speeds& speeds = body_.motion.speeds;
  const double longest = body_.motion.longest_move;
  if (!(speeds.fastest * dt < longest)) return true;
  return first_try && speeds.reversing * dt > 0.02 * longest;
}

// The vertex that is fastest or not a number, for messages.
template <class Real>
std::string World<Real>::culprit() const {
  Index worst = -1;
  double fastest = -1;
  const Topology& topology = elements().topology;
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    if (topology.around(v).empty()) continue;
    const double speed = double(body_.motion.v.col(v).norm());
    if (speed <= fastest) continue;
    worst = v;
    fastest = speed;
    if (!std::isfinite(speed)) break;
  }
  if (worst < 0) return "";
  return "vertex " + std::to_string(worst) + " of tetrahedron " +
         std::to_string(topology.around(worst).front()) + " was the fastest; ";
}

template <class Real>
Report World<Real>::advance(double duration) {
  if (!(duration > 0) || !std::isfinite(duration))
    throw InputError("advance", "the duration must be above 0 s and finite, not " + std::to_string(duration));
  Report report;
  const PatchCount before = body_.regions.patch_count();
  const double end = time() + duration, shortest = 1e-9 * duration;
  scalpels_.begin_frame();
  begin_frame(duration);
  while (report.ok && time() < end - shortest) {
    const double next = tools_.next_grasp_change(time() + shortest);
    advance_to(next < end - shortest ? next : end, report);
  }
  const PatchCount after = body_.regions.patch_count();
  report.patches_evaluated = after.evaluated - before.evaluated;
  report.patches_skipped = after.skipped - before.skipped;
  report.transitions = std::exchange(next_report_.transitions, {});
  lobe_assert(body_.motion.u.count() == elements().topology.vertex_count(), "a vertex has no displacement");
  if constexpr (is_debug_build)
    if (report.tets_removed > 0 || report.cut_area > 0) validate(*this);
  return report;
}

template <class Real>
void World<Real>::begin_frame(double duration) {
  tools_.begin_frame(time(), duration);
  for (const auto& term : body_.terms) term->begin_frame(time(), duration);
  show_tools(time(), time() + duration);
}

// Performs edits, tools and cuts at the start of a frame, and finds the step limit that follows from them.
template <class Real>
void World<Real>::prepare_frame(double duration, Report& report) {
  condense_anew();
  refresh_terms();
  if (!implicit_ && limit_.is_due(body_)) {
    const Timed timed(report, Phase::time_step);
    limit_.find_anew(body_);
    limit_.measure_again(body_);
    limit_.keep(body_);
    unravel();
  }
  play_tools(duration, report);
  show_body();
  bool has_changed = false;
  {
    const Timed timed(report, Phase::cutting);
    has_changed = embed();
  }
  if (has_changed) show_body();  // in which other vertices have masses now
  {
    const Timed timed(report, Phase::time_step);
    report.time_step_limit = limit_.for_frame(body_);
    if (slow_strained()) report.time_step_limit = limit_.for_frame(body_);
    report.limiting_vertex = limit_.limiting_vertex();
  }
  const double ratio = limit_.volume_ratio();
  report.smallest_volume_ratio = std::min(report.smallest_volume_ratio, ratio);
  if (ratio < 0.05) report.conditions.push_back(near_inversion(ratio, limit_.volume_ratio_tet(), time()));
}

template <class Real>
void World<Real>::advance_to(double end, Report& report) {
  const double duration = end - time();
  const int transitions = next_report_.transitions.count;
  prepare_frame(duration, report);
  const bool in_transition = next_report_.transitions.count != transitions;
  constexpr int most_steps = 1 << 20, most_tries = 9;
  const double longest = !implicit_                 ? setup_.safety * report.time_step_limit
                         : setup_.implicit_step > 0 ? setup_.implicit_step
                                                    : duration;
  const double wanted = std::ceil(duration / longest * (1 - 1e-12));
  if (!(wanted <= most_steps)) {
    report.ok = false;
    report.conditions.push_back(too_stiff(report.time_step_limit, time()));
    return;
  }
  int steps = std::max(1, static_cast<int>(wanted));
  for (const auto& term : body_.terms) term->begin_steps();
  StateColumns<Real> start = body_.motion;
  const Sleep::State sleep_at_start = body_.sleep.state();
  double step = 0;
  std::string fastest;
  for (int attempt = 0; attempt < most_tries && steps <= most_steps; ++attempt) {
    step = duration / steps;
    const bool done = run_steps(steps, step, attempt == 0, report);
    std::vector<Index> unseen;
    if (done && !body_.terms.empty()) unseen = body_.regions.pressed_unseen(body_.motion);
    double limit_after = std::numeric_limits<double>::infinity();
    if (done && !implicit_) {
      const Timed timed(report, Phase::time_step);
      limit_after = limit_.at_end(body_);
    }
    // If the body has become too stiff for the step that was taken, it may have begun to swing.
    if (done && ((step <= limit_after && unseen.empty()) || attempt == most_tries - 1)) {
      if (!unseen.empty()) notice(Condition::Kind::lost_force, lost_on_lattice(unseen.front()));
      body_.motion.time = end;
      report.time_step = report.time_step > 0 ? std::min(report.time_step, step) : step;
      if (attempt > 0) report.conditions.push_back(sub_stepped(attempt + 1, steps, start.time));
      return;
    }
    fastest = culprit();
    go_back(start, sleep_at_start);
    ++report.reruns;
    if (!unseen.empty()) {  // the frame is run again, in which they move by themselves
      embed(unseen);
      show_body();
      start = body_.motion;
      limit_after = std::min(limit_after, limit_.for_frame(body_));
    }
    const double wanted_now = std::min<double>(duration / (setup_.safety * limit_after), most_steps);
    const bool may_snap = in_transition && attempt == 0;
    const int more = static_cast<int>(std::ceil((may_snap ? more_for_snap : 2) * steps));
    steps = unseen.empty() ? std::max(more, static_cast<int>(wanted_now))
                           : std::max(steps, static_cast<int>(std::ceil(wanted_now)));
  }
  report.ok = false;
  report.time_step = step;
  report.conditions.push_back(diverged(step, fastest, time()));
}

template <class Real>
void World<Real>::go_back(const StateColumns<Real>& state, const Sleep::State& sleep) {
  static_cast<StateColumns<Real>&>(body_.motion) = state;
  body_.sleep.set_state(sleep);
  body_.state_was_replaced();
  for (const auto& term : body_.terms) term->take_back_steps();
}

// Takes the result of condensing when it is due, and waits for it if necessary, so that a run has the same
// bits on every machine.
template <class Real>
void World<Real>::condense_anew() {
  constexpr double delay = 1;  // [s]
  if (body_.regions.is_condensing() && time() >= body_.regions.condensing_due())
    end_condensing();
  else if (body_.regions.needs_condensing())
    begin_condensing({time() + delay});
}

// Unravels tetrahedra that stay crushed. The search for the step limit has found the smallest det F.
template <class Real>
void World<Real>::unravel() {
  if (elements().guard_below == 0) return;
  const bool was_lumped = unravelling_.is_lumped();
  unravelling_.lump(body_, limit_.volume_ratio());
  if (unravelling_.is_lumped() != was_lumped)
    notice(Condition::Kind::lumped, was_lumped
                                        ? "nothing is crushed any more: masses are selective again"
                                        : "tetrahedra are crushed: masses are lumped until they are not");
  use_mass_degree(unravelling_.is_lumped() ? 1 : body_.inertia.degree());
  const auto was_held = [&](Index tet) { return pieces_.was_held(tet); };
  const auto remedy = unravelling_.look(body_, limit_.volume_ratio(), was_held);
  if (!remedy) return;
  notice(Condition::Kind::unravelling, remedy->why);
  change_region(remedy->tets, remedy->model);
}

template <class Real>
void World<Real>::play_tools(double duration, Report& report) {
  const Timed timed(report, Phase::cutting);
  const auto displacement = [&](Index v) -> Vec3d { return state().u.col(v).template cast<double>(); };
  const auto position = [&](Index v) -> Vec3d { return elements().points.col(v) + displacement(v); };
  const auto exists = [&](Index v) {
    return v < elements().topology.vertex_count() && !elements().topology.around(v).empty() &&
           !(grains() && !grains()->fills(v, elements()));
  };
  HeldVertices now = held();
  if (tools_.update_grasps(time(), now, displacement, position, exists)) {
    synchronise_velocities();
    hold(now);
    report.tets_removed += treat_loose(pieces_.loosened(body_.model));
  }
  const ToolWork work = tools_.work(time(), time() + duration);
  for (const SweptVolume& volume : work.burnt) {
    std::vector<Index> burnt = meeting(volume);
    if (grains()) scalpels_.keep_filled(volume, elements(), body_now(), burnt);
    report.tets_removed += remove_tets(burnt);
  }
  for (const BladeMove& move : work.cuts) incise(move, report);
  scalpels_.end_strokes();
  report.mass_added = body_.inertia.mass_of_floor();
  std::vector<Condition>& found = next_report_.conditions;
  report.conditions.insert(report.conditions.end(), found.begin(), found.end());
  found.clear();
}

// Computes where vertices are that follow others, before a tool searches them. How far they have moved is not
// known.
template <class Real>
void World<Real>::see_interior() {
  if (!body_.regions.any_following() || seen_ == body_.model.revisions) return;
  ++body_.model.revisions.jumps;
  state();
  seen_ = body_.model.revisions;
}

template <class Real>
std::vector<Index> World<Real>::meeting(const SweptVolume& volume) {
  see_interior();
  return tools_.meeting(body_.model, body_.motion.u.padded(), volume);
}

}  // namespace lobe
