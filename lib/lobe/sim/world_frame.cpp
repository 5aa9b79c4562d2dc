// A frame of a World, and what happens on trouble (theory, section 8).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "lobe/error.h"
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

Condition near_inversion(double volume_ratio, Index tet, double time) {
  return {Condition::Kind::near_inversion,
          "tetrahedron " + std::to_string(tet) + " is at " + rounded(volume_ratio) + " of its volume" +
              (volume_ratio < 0 ? ", inverted" : "") +
              ": guard_below, a larger volume_penalty, a smaller load or a slower tool may help",
          time};
}

Condition too_stiff(double limit, double time) {
  return {Condition::Kind::too_stiff,
          "steps of " + rounded(limit) +
              " s are all that is stable, more than a million per frame: use softer materials, a coarser "
              "mesh or a shorter frame",
          time};
}

Condition diverged(double step, const std::string& fastest, double time) {
  return {
      Condition::Kind::diverged,
      "no step down to " + rounded(step) + " s was stable; " + fastest +
          "displacements and velocities before it are kept. Use a smaller load or tool speed, more damping, "
          "guard_below or a volume_penalty",
      time};
}

// What is led may be led beyond the numbers, which no force notices where nothing that moves by itself is near.
template <class State>
bool led_are_finite(const HeldVertices& held, const State& state) {
  return std::all_of(held.all().begin(), held.all().end(), [&](const HeldVertices::Held& item) {
    return state.u.col(item.vertex).allFinite() && state.v.col(item.vertex).allFinite();
  });
}

}  // namespace

// False as soon as a vertex is not a number or moves further than an edge in one step; in a first try already where one
// swings to and fro, ever faster, by more than a fiftieth of that: a state of high frequency in its own right looks the
// same, and is left alone in the second try.
template <class Real>
bool World<Real>::run_steps(int steps, double dt, bool first_try, Report& report) {
  frame_begins_ = true;
  std::fill(turns_.begin(), turns_.end(), 0);
  for (int i = 0; i < steps; ++i) {
    if (implicit_) {
      const Timed timed(report, Phase::integration);
      if (!implicit_step(dt)) return false;
      ++report.steps;
      continue;
    }
    {
      const Timed timed(report, Phase::forces);
      forces();
    }
    const Timed timed(report, Phase::integration);
    integrate(dt);
    ++report.steps;
    if (!(fastest_ * dt < longest_move_)) return false;
    if (first_try && turned_ * dt > 0.02 * longest_move_) return false;
  }
  return led_are_finite(held_, state_);
}

// The vertex that is fastest or not a number, for messages.
template <class Real>
std::string World<Real>::culprit() const {
  Index worst = -1;
  double fastest = -1;
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v) {
    if (elements_.topology.around(v).empty()) continue;
    const double speed = double(state_.v.col(v).norm());
    if (speed <= fastest) continue;
    worst = v;
    fastest = speed;
    if (!std::isfinite(speed)) break;
  }
  if (worst < 0) return "";
  return "vertex " + std::to_string(worst) + " of tetrahedron " +
         std::to_string(elements_.topology.around(worst).front()) + " was the fastest; ";
}

template <class Real>
Report World<Real>::advance(double duration) {
  if (!(duration > 0) || !std::isfinite(duration))
    throw InputError("advance", "the duration must be above 0 s and finite, not " + std::to_string(duration));
  Report report;
  const PatchCount before = patch_count();
  const double end = state_.time + duration, shortest = 1e-9 * duration;
  while (report.ok && state_.time < end - shortest) {
    const double next = tools_.next_grasp_change(state_.time + shortest);
    advance_to(next < end - shortest ? next : end, report);
  }
  report.patches_evaluated = patch_count().evaluated - before.evaluated;
  report.patches_skipped = patch_count().skipped - before.skipped;
  return report;
}

// Tools, cuts, and the time step limit that follows from them.
template <class Real>
void World<Real>::prepare_frame(double duration, Report& report) {
  refresh_condensed();
  {
    const Timed timed(report, Phase::time_step);
    if (known_ != Known::anew) find_frequencies();
    measure_again();
  }
  unravel();
  play_tools(duration, report);
  {
    const Timed timed(report, Phase::time_step);
    report.time_step_limit = time_step_limit();
    report.limiting_vertex = limiting_vertex_;
  }
  report.smallest_volume_ratio = std::min(report.smallest_volume_ratio, volume_ratio_);
  if (volume_ratio_ < 0.05)
    report.conditions.push_back(near_inversion(volume_ratio_, volume_ratio_tet_, state_.time));
}

template <class Real>
void World<Real>::advance_to(double end, Report& report) {
  const double duration = end - state_.time;
  prepare_frame(duration, report);
  constexpr int most_steps = 1 << 20, most_tries = 9;
  const double longest = !implicit_                 ? setup_.safety * report.time_step_limit
                         : setup_.implicit_step > 0 ? setup_.implicit_step
                                                    : duration;
  const double wanted = std::ceil(duration / longest * (1 - 1e-12));
  if (!(wanted <= most_steps)) {
    report.ok = false;
    report.conditions.push_back(too_stiff(report.time_step_limit, state_.time));
    return;
  }
  int steps = std::max(1, static_cast<int>(wanted));
  const auto start = state_;
  const Sleep::State sleep_at_start = sleep_.state();
  double step = 0;
  std::string fastest;
  for (int attempt = 0; attempt < most_tries && steps <= most_steps; ++attempt) {
    step = duration / steps;
    const bool done = run_steps(steps, step, attempt == 0, report);
    double limit_after = std::numeric_limits<double>::infinity();
    if (done && !implicit_) {
      const Timed timed(report, Phase::time_step);
      limit_after = time_step_limit();
    }
    // What has stiffened beyond the step that was taken may have begun to swing.
    if (done && (step <= limit_after || attempt == most_tries - 1)) {
      state_.time = end;
      report.time_step = report.time_step > 0 ? std::min(report.time_step, step) : step;
      if (attempt > 0)
        report.conditions.push_back(
            {Condition::Kind::sub_stepped,
             "it took " + std::to_string(attempt + 1) + " tries and " + std::to_string(steps) + " steps",
             start.time});
      return;
    }
    fastest = culprit();
    state_ = start;
    sleep_.set_state(sleep_at_start);
    implicit_is_stale_ = kept_is_stale_ = moving_is_stale_ = true;
    interior_ = Interior::stale;
    known_ = Known::stale;
    groups_.forget();
    ++report.reruns;
    const double wanted_now = duration / (setup_.safety * limit_after);
    steps = std::max(2 * steps, static_cast<int>(std::min<double>(wanted_now, most_steps)));
  }
  report.ok = false;
  report.time_step = step;
  report.conditions.push_back(diverged(step, fastest, state_.time));
}

template <class Real>
void World<Real>::play_tools(double duration, Report& report) {
  const Timed timed(report, Phase::cutting);
  const auto displacement = [&](Index v) -> Vec3d { return state().u.col(v).template cast<double>(); };
  const auto exists = [&](Index v) { return !elements_.topology.around(v).empty(); };
  HeldVertices held = held_;
  if (tools_.update_grasps(state_.time, held, displacement, exists)) {
    catch_up();
    refresh_held(std::exchange(held_, held));
    report.tets_removed += treat_loose_pieces(elements_.topology.pieces());
  }
  for (const Sweep& sweep : tools_.sweeps(state_.time, state_.time + duration))
    report.tets_removed += remove_tets(touched(sweep));
  report.conditions.insert(report.conditions.end(), pending_.begin(), pending_.end());
  pending_.clear();
}

template <class Real>
std::vector<Index> World<Real>::touched(const Sweep& sweep) {
  if (precomputed_.tet_count() > 0) {  // its interior moves as it likes
    groups_.forget();
    state();
  }
  return groups_.touched(elements_.topology, elements_.points.padded(), state_.u.padded(), sweep);
}

template class World<float>;
template class World<double>;

}  // namespace lobe
