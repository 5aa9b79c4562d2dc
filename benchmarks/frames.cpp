#include "benchmarks/frames.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <sstream>

#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

constexpr double frames[] = {0.001, 0.002, 0.005, 0.01, 0.02};  // [s]
constexpr int repetitions = 5;

FrameCost play(World<float>& world, double frame, double seconds) {
  using Clock = std::chrono::steady_clock;
  const int count = static_cast<int>(seconds / frame + 0.5);
  FrameCost cost{.frame = frame};
  double all = 0, of_steps = 0;
  for (int i = 0; i < count; ++i) {
    const auto start = Clock::now();
    const Report report = world.advance(frame);
    const double took = std::chrono::duration<double>(Clock::now() - start).count();
    all += took;
    cost.longest = std::max(cost.longest, took);
    cost.steps += double(report.steps) / count;
    of_steps += report.seconds[std::size_t(Phase::forces)] + report.seconds[std::size_t(Phase::integration)];
  }
  cost.over_steps = all / of_steps;
  return cost;
}

}  // namespace

std::vector<FrameCost> frame_costs(const Setup& setup, double seconds) {
  std::vector<FrameCost> costs;
  for (const double frame : frames) {
    World<float> world(setup);
    world.advance(0.05);
    std::vector<FrameCost> samples;
    for (int i = 0; i < repetitions; ++i) samples.push_back(play(world, frame, seconds));
    std::sort(samples.begin(), samples.end(),
              [](const FrameCost& a, const FrameCost& b) { return a.over_steps < b.over_steps; });
    costs.push_back(samples[repetitions / 2]);
  }
  return costs;
}

void print(const std::vector<FrameCost>& costs, const std::string& mesh) {
  std::printf("\n%-10s %10s %12s %12s %14s\n", "mesh", "frame ms", "steps", "over steps", "longest ms");
  for (const FrameCost& c : costs)
    std::printf("%-10s %10.0f %12.1f %12.3f %14.3f\n", mesh.c_str(), 1e3 * c.frame, c.steps, c.over_steps,
                1e3 * c.longest);
}

std::string csv(const std::vector<FrameCost>& costs, const std::string& mesh) {
  std::ostringstream out;
  out << "mesh,frame_ms,steps,over_steps,longest_ms\n";
  for (const FrameCost& c : costs)
    out << mesh << ',' << 1e3 * c.frame << ',' << c.steps << ',' << c.over_steps << ',' << 1e3 * c.longest
        << '\n';
  return out.str();
}

}  // namespace lobe::bench
