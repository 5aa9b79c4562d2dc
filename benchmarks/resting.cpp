#include "benchmarks/resting.h"

#include <algorithm>
#include <cmath>

#include "benchmarks/benchmarks.h"
#include "benchmarks/timing.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

constexpr double lift = 0.02, moving = 0.5;  // [m], [s]

// On one thread, by its processor time [s].
Report timed_advance(World<float>& world, double frame, double& seconds) {
  const Stopwatch watch(true);
  Report report = world.advance(frame);
  seconds += watch.seconds();
  if (!report.ok) throw WrongResult("a gesture with rests ended early: " + report.conditions.back().text);
  return report;
}

}  // namespace

Resting play_with_rests(Setup setup, double frame, double rest) {
  const double let_down = moving + rest, end = 2 * (moving + rest);  // [s]
  setup.cauteries.clear();
  setup.grasps.resize(1);
  setup.grasps[0].release = false;
  setup.grasps[0].path = {{0, Vec3d::Zero()},
                          {moving, {0, 0, lift}},
                          {let_down, {0, 0, lift}},
                          {let_down + moving, Vec3d::Zero()}};
  World<float> awake(setup);
  Resting result;
  setup.sleep = result.tolerance = 1e-3 * lift;
  World<float> asleep(setup);
  std::array<long long, 2> evaluated{}, skipped{};
  double largest = 0;
  for (int i = 0; i < std::lround(end / frame); ++i) {
    const int part = std::fmod(awake.time() + frame / 2, let_down) < moving ? 0 : 1;
    timed_advance(awake, frame, result.parts[part].awake);
    const Report report = timed_advance(asleep, frame, result.parts[part].asleep);
    evaluated[part] += report.patches_evaluated;
    skipped[part] += report.patches_skipped;
    const auto u = awake.state().u;
    largest = std::max(largest, double(u.colwise().norm().maxCoeff()));
    result.error = std::max(result.error, double((u - asleep.state().u).colwise().norm().maxCoeff()));
  }
  result.error /= largest;
  for (int part = 0; part < 2; ++part) {
    const double simulated = 2 * (part == 0 ? moving : rest);
    result.parts[part].awake /= simulated;
    result.parts[part].asleep /= simulated;
    result.parts[part].skipped = double(skipped[part]) / double(skipped[part] + evaluated[part]);
  }
  return result;
}

}  // namespace lobe::bench
