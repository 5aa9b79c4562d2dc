#include "benchmarks/accuracy_play.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "benchmarks/benchmarks.h"
#include "benchmarks/timing.h"
#include "lobe/linearity/mass_watch.h"
#include "lobe/linearity/reduced_watch.h"
#include "lobe/sim/world.h"
#include "lobe/text.h"

namespace lobe::bench {
namespace {

constexpr double short_run = 0.1;  // [s]
constexpr int most_repetitions = 3;
constexpr double tolerance = 0.02;

std::string remark(Condition::Kind kind) {
  switch (kind) {
    case Condition::Kind::sub_stepped:
      return "sub-stepped";
    case Condition::Kind::near_inversion:
      return "near inversion";
    case Condition::Kind::pieces:
      return "pieces";
    case Condition::Kind::unravelling:
      return "unravelling";
    default:
      return "";
  }
}

// What corrects a world while it runs.
template <class Real>
class Watches {
 public:
  explicit Watches(World<Real>& world) {
    if (world.body().inertia.is_selective()) masses_.emplace(world, tolerance);
    if (world.body().regions.any_reduced())
      reduced_.emplace(world, ReducedOptions{.tolerance = tolerance, .correct = true});
    look(world);
  }
  void look(World<Real>& world) {
    if (masses_) masses_->look(world);
    if (reduced_) reduced_->look(world);
  }

 private:
  std::optional<MassWatch<Real>> masses_;
  std::optional<ReducedWatch<Real>> reduced_;
};

template <class Real>
Played play_once(const Setup& setup, const Schedule& schedule, const Way& way, bool is_corrected) {
  Setup with_safety = setup;
  with_safety.safety = way.safety;
  World<Real> world(with_safety, way.threads);
  std::optional<Watches<Real>> watches;
  if (is_corrected) watches.emplace(world);
  Played played;
  std::set<std::string> remarks;
  double seconds = 0;
  long long steps = 0;
  for (int frame = 1; frame <= schedule.frames && played.to_the_end; ++frame) {
    const Stopwatch watch(way.threads == 1);
    const Report report = world.advance(schedule.frame);
    if (watches && report.ok) watches->look(world);
    seconds += played.frames.emplace_back(watch.seconds());
    steps += report.steps;
    played.to_the_end = report.ok;
    for (const Condition& c : report.conditions)
      if (const std::string text = remark(c.kind); !text.empty()) remarks.insert(text);
    if (!report.ok)
      played.status =
          std::string(name(report.conditions.back().kind)) + " at " + rounded(world.time()) + " s";
    else if (frame % (schedule.frames / schedule.samples) == 0)
      played.samples.push_back(world.state().u.template cast<double>());
  }
  played.dt = world.time() / double(std::max(1LL, steps));
  played.wall_per_s = seconds / std::max(world.time(), schedule.frame);
  if (played.to_the_end) {
    played.status = "done";
    for (const std::string& text : remarks) played.status += "; " + text;
  }
  return played;
}

Played play_in_precision(const Setup& setup, const Schedule& schedule, const Way& way, bool is_corrected) {
  return way.precision == Precision::single_precision ? play_once<float>(setup, schedule, way, is_corrected)
                                                      : play_once<double>(setup, schedule, way, is_corrected);
}

}  // namespace

Schedule schedule_of(const Time& time, int samples) {
  Schedule schedule;
  schedule.samples = samples;
  const double frames_per_sample = std::ceil(time.duration / (time.frame * samples) * (1 - 1e-9));
  schedule.frames = samples * static_cast<int>(frames_per_sample);
  schedule.frame = time.duration / schedule.frames;
  return schedule;
}

Played play(const Setup& setup, const Schedule& schedule, const Way& way, bool is_corrected) {
  Played played = play_in_precision(setup, schedule, way, is_corrected);
  const bool again = played.to_the_end && played.wall_per_s * schedule.duration() < short_run;
  for (int i = 1; again && i < most_repetitions; ++i)
    played.wall_per_s =
        std::min(played.wall_per_s, play_in_precision(setup, schedule, way, is_corrected).wall_per_s);
  return played;
}

Samples play_reference(const Setup& setup, const Schedule& schedule, double safety, int threads) {
  Played played = play_once<double>(setup, schedule, {Precision::double_precision, safety, threads}, false);
  if (!played.to_the_end)
    throw WrongResult(
        "the reference of " + std::to_string(setup.mesh.tet_count()) +
        " tetrahedra did not run to its end (" + played.status +
        "): there is nothing to compare with. A gentler gesture, a volume_penalty or more damping "
        "may help");
  return std::move(played.samples);
}

}  // namespace lobe::bench
