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

Condition near_inversion(double volume_ratio, Index tet, const Elements& elements, double time) {
  return {Condition::Kind::near_inversion,
          "tetrahedron " + std::to_string(tet) + elements.bodies.in_words(tet) + " is at " +
              rounded(volume_ratio) + " of its volume" + (volume_ratio < 0 ? ", inverted" : "") +
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

// Whether a vertex is not a number or moved further than an edge in one step. In a first try it also checks
// for vertices that swing to and fro, ever faster, by more than a fiftieth of an edge. A body that really has
// such high frequencies looks the same, so later tries skip this check.
template <class Real>
bool is_in_trouble(const Motion<Real>& motion, double dt, bool first_try) {
  const Speeds& speeds = motion.speeds;
  const double longest = motion.longest_move;
  if (!(speeds.fastest * dt < longest)) return true;
  return first_try && speeds.reversing * dt > 0.02 * longest;
}

// The vertex that is fastest or not a number, for messages.
template <class Real>
std::string culprit(const Topology& topology, const Motion<Real>& motion) {
  Index worst = -1;
  double fastest = -1;
  for (Index v = 0; v < topology.vertex_count(); ++v) {
    if (topology.around(v).empty()) continue;
    const double speed = double(motion.v.col(v).norm());
    if (speed <= fastest) continue;
    worst = v;
    fastest = speed;
    if (!std::isfinite(speed)) break;
  }
  if (worst < 0) return "";
  return "vertex " + std::to_string(worst) + " of tetrahedron " +
         std::to_string(topology.around(worst).front()) + " was the fastest; ";
}

void check_duration(double duration) {
  if (!(duration > 0) || !std::isfinite(duration))
    throw InputError("advance", "the duration must be above 0 s and finite, not " + std::to_string(duration));
}

template <class Real>
void go_back(const StateColumns<Real>& state, const Sleep::State& sleep, Dynamics<Real>& body) {
  static_cast<StateColumns<Real>&>(body.motion) = state;
  body.sleep.set_state(sleep);
  body.regions.take_back_dashpots();
  body.state_was_replaced();
  for (const auto& term : body.terms) term->take_back_steps();
}

void give_up(Report& report, Condition why) {
  report.ok = false;
  report.conditions.push_back(std::move(why));
}

// What a step of the next frame may last [s].
template <class Real>
double longest_step(const Organ<Real>& organ, double limit, double duration) {
  if (!organ.implicit()) return organ.setup().safety * limit;
  return organ.setup().implicit_step > 0 ? organ.setup().implicit_step : duration;
}

// The limit of the state at the end of a frame [s].
template <class Real>
double limit_at_end(Organ<Real>& organ, Dynamics<Real>& body, Report& report) {
  if (organ.implicit()) return std::numeric_limits<double>::infinity();
  const Timed timed(report, Phase::time_step);
  return organ.limit().at_end(body);
}

// Ends levels before a frame is run again.
template <class Real>
void step_together(Dynamics<Real>& body, StateColumns<Real>& start) {
  if (!body.own_steps || !body.own_steps->any()) return;
  body.own_steps->end_after_trouble(body);
  start = body.motion;
}

}  // namespace

template <class Real>
bool World<Real>::step(double dt) {
  begin_frame(dt);
  organ_.show_body();
  if (body().own_steps) body().own_steps->end(body());
  tools_.begin_forces();
  Report unread;
  if (!take_step(dt, unread)) return false;
  tools_.end_forces(dt);
  return true;
}

// False if an implicit step was not solved.
template <class Real>
bool World<Real>::take_step(double dt, Report& report) {
  if (!organ_.implicit()) {
    const Timed timed(report, Phase::forces);
    body().find_forces(body().kick_of(dt));
  }
  const Timed timed(report, Phase::integration);
  if (organ_.implicit() && !implicit_step(dt)) return false;
  if (!organ_.implicit()) move(dt);
  ++report.steps;
  return true;
}

// Returns false as soon as a step fails its checks.
template <class Real>
bool World<Real>::run_steps(int steps, double dt, bool first_try, Report& report) {
  body().sleep.begin_frame();
  tools_.begin_forces();
  if (body().own_steps) body().own_steps->begin_steps();
  for (Reversals* turns : {&body().motion.reversals, &body().motion.node_turns})
    std::fill(turns->begin(), turns->end(), 0);
  for (int i = 0; i < steps; ++i) {
    if (!take_step(dt, report)) return false;
    if (!organ_.implicit() && is_in_trouble(body().motion, dt, first_try)) return false;
  }
  tools_.end_forces(steps * dt);
  return driven_are_finite(held(), body().motion);
}

template <class Real>
Report World<Real>::advance(double duration) {
  check_duration(duration);
  Report report;
  const PatchCount before = body().regions.patch_count();
  const double end = time() + duration, shortest = 1e-9 * duration;
  organ_.blades().begin_frame();
  begin_frame(duration);
  while (report.ok && time() < end - shortest) {
    const double next = tools_.next_grasp_change(time() + shortest);
    advance_to(next < end - shortest ? next : end, report);
  }
  organ_.report_frame(before, report);
  lobe_assert(body().motion.u.count() == elements().topology.vertex_count(), "a vertex has no displacement");
  if constexpr (is_debug_build)
    if (report.tets_removed > 0 || report.cut_area > 0) validate(*this);
  return report;
}

template <class Real>
void World<Real>::begin_frame(double duration) {
  sew();
  tools_.begin_frame(time(), duration);
  for (const auto& term : body().terms) term->begin_frame(time(), duration);
  organ_.show_tools(tools_.bodies(time(), time() + duration));
  organ_.show_needles(tools_.needles(time(), time() + duration), time(), time() + duration);
}

// Performs edits, tools and cuts at the start of a frame, and finds the step limit that follows from them.
template <class Real>
void World<Real>::prepare_frame(double duration, Report& report) {
  organ_.grant({Moment::frame_begins});
  organ_.refresh_terms();
  if (!organ_.implicit() && organ_.limit().is_due(body())) {
    const Timed timed(report, Phase::time_step);
    // The limit that the end of the last frame found does not look a frame ahead (Contact).
    if (organ_.setup().contact.self && elements().bodies.count() > 1) organ_.limit().forget();
    organ_.limit().find_anew(body());
    organ_.limit().measure_again(body());
    organ_.limit().keep(body());
    organ_.grant({Moment::limit_is_found});
  }
  play_tools(duration, report);
  organ_.show_body();
  bool has_changed = false;
  {
    const Timed timed(report, Phase::cutting);
    has_changed = organ_.grant({Moment::steps_begin});
  }
  if (has_changed) organ_.show_body();  // its masses are others now
  {
    const Timed timed(report, Phase::time_step);
    report.time_step_limit = organ_.limit().for_frame(body());
    if (organ_.grant({Moment::step_is_chosen})) report.time_step_limit = organ_.limit().for_frame(body());
    report.limiting_vertex = organ_.limit().limiting_vertex();
  }
  const double ratio = organ_.limit().volume_ratio();
  report.smallest_volume_ratio = std::min(report.smallest_volume_ratio, ratio);
  if (ratio < 0.05)
    report.conditions.push_back(near_inversion(ratio, organ_.limit().volume_ratio_tet(), elements(), time()));
}

template <class Real>
void World<Real>::advance_to(double end, Report& report) {
  const double duration = end - time();
  const int transitions = organ_.unreported().transitions.count;
  prepare_frame(duration, report);
  const bool in_transition = organ_.unreported().transitions.count != transitions;
  constexpr int most_steps = 1 << 20, most_tries = 9;
  const double longest = longest_step(organ_, report.time_step_limit, duration);
  const double wanted = std::ceil(duration / longest * (1 - 1e-12));
  if (!(wanted <= most_steps)) return give_up(report, too_stiff(report.time_step_limit, time()));
  int steps = std::max(1, static_cast<int>(wanted));
  auto& own_steps = body().own_steps;
  if (own_steps) steps = own_steps->begin_frame(body(), steps, duration / steps, organ_.setup().safety);
  for (const auto& term : body().terms) term->begin_steps();
  StateColumns<Real> start = body().motion;
  body().regions.keep_dashpots();
  const Sleep::State sleep_at_start = body().sleep.state();
  double step = 0;
  std::string fastest;
  for (int attempt = 0; attempt < most_tries && steps <= most_steps; ++attempt) {
    step = duration / steps;
    const bool done = run_steps(steps, step, attempt == 0, report);
    std::vector<Index> unseen;
    if (done && !body().terms.empty()) unseen = body().regions.pressed_unseen(body().motion);
    double limit_after =
        done ? limit_at_end(organ_, body(), report) : std::numeric_limits<double>::infinity();
    // If the body has become too stiff for the step that was taken, it may have begun to swing.
    const bool were_levels_too_high =
        done && step <= limit_after && own_steps && !own_steps->are_stable(step);
    const bool is_stable = step <= limit_after && !were_levels_too_high;
    if (done && ((is_stable && unseen.empty()) || attempt == most_tries - 1)) {
      if (!unseen.empty()) organ_.report_unseen_force(unseen.front());
      body().motion.time = end;
      aim_hold_springs();
      report.time_step = report.time_step > 0 ? std::min(report.time_step, step) : step;
      if (attempt > 0) report.conditions.push_back(sub_stepped(attempt + 1, steps, start.time));
      return;
    }
    fastest = culprit(elements().topology, body().motion);
    go_back(start, sleep_at_start, body());
    ++report.reruns;
    step_together(body(), start);
    if (!unseen.empty()) {  // the frame is run again, in which they move by themselves
      organ_.grant({Moment::steps_begin, {}, unseen});
      organ_.show_body();
      start = body().motion;
      body().regions.keep_dashpots();
      limit_after = std::min(limit_after, organ_.limit().for_frame(body()));
    }
    const double wanted_now = std::min<double>(duration / (organ_.setup().safety * limit_after), most_steps);
    const bool may_snap = in_transition && attempt == 0;
    const double times = were_levels_too_high ? 1 : may_snap ? more_for_snap : 2;
    steps = unseen.empty()
                ? std::max(static_cast<int>(std::ceil(times * steps)), static_cast<int>(wanted_now))
                : std::max(steps, static_cast<int>(std::ceil(wanted_now)));
  }
  report.time_step = step;
  give_up(report, diverged(step, fastest, time()));
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
  if (tools_.update_grasps(time(), now, displacement, position, exists))
    report.tets_removed += organ_.grasp(now);
  const ToolWork work = tools_.work(time(), time() + duration);
  for (const ClipClosure& clip : work.clips) organ_.close(clip);
  for (const SweptVolume& volume : work.burnt) {
    organ_.sever(volume);
    report.tets_removed += organ_.burn(volume);
  }
  for (const BladeMove& move : work.cuts) {
    organ_.sever(move);
    cut(move, report);
  }
  organ_.blades().end_strokes();
  report.mass_added = body().inertia.mass_of_floor();
  std::vector<Condition>& found = organ_.unreported().conditions;
  report.conditions.insert(report.conditions.end(), found.begin(), found.end());
  found.clear();
}

// Draws the threads of needles through the bites that these made in the last frame.
template <class Real>
void World<Real>::sew() {
  for (const NeedleBite& bite : organ_.take_bites())
    tools_.visit(bite.tool, [&](const auto& tool) {
      if constexpr (requires { tool.thread; })
        if (tool.thread) organ_.sew(bite, {*tool.thread, tool.material, tool.thread_length, tool.ties});
    });
}

template <class Real>
void World<Real>::cut(const BladeMove& move, Report& report) {
  const typename Organ<Real>::Cut made = organ_.cut(move);
  for (const BladeWork::Step& step : made.steps)
    tools_.cut_by(move.tool, work_of(step.incised, elements()), step.incised.way, step.tip);
  report.cut_area += made.area;
  report.tets_copied += made.copied;
  report.tets_removed += made.removed;
}

}  // namespace lobe
