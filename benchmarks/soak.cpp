// lobe bench soak: long sessions (soak_sessions.h). Then for --minutes N gestures with random tool noise, one
// after the other, invariants checked every second, one line in the end.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

#include "benchmarks/benchmarks.h"
#include "benchmarks/machine.h"
#include "benchmarks/soak_sessions.h"
#include "benchmarks/stress/plan.h"
#include "lobe/file/atomic_file.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"

namespace lobe::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Tally {
  long gestures = 0, frames = 0, steps = 0, reruns = 0, removed = 0, checks = 0, stopped = 0;
  double smallest_ratio = 1, largest_difference = 0;  // of det F; of a cut world to one built afresh
};

// A grasp that drags with a tremor, and a cautery that wanders across the organ.
Setup gesture(const stress::Subject& organ, std::mt19937& random) {
  constexpr double frame = 1.0 / 60, duration = 2;
  std::normal_distribution<double> normal;
  const auto noise = [&](double size) {
    return Vec3d(size * Vec3d(normal(random), normal(random), normal(random)));
  };
  const auto vertex = [&] {
    return std::uniform_int_distribution<Index>(0, organ.mesh.vertex_count() - 1)(random);
  };
  Setup setup = stress::held_tissue(organ, random() % 2 == 0 ? "mixed" : "nonlinear");
  setup.gravity = {0, 0, -9.81};
  setup.loose_pieces = LoosePieces(random() % 3);
  GraspSetup grasp{"grasper", {}, {}, true};
  const Vec3d taken = organ.mesh.points.col(vertex());
  for (Index v = 0; v < organ.mesh.vertex_count(); ++v)
    if ((organ.mesh.points.col(v) - taken).norm() < 0.1 * organ.length()) grasp.vertices.push_back(v);
  CauterySetup cautery{"bipolar", 0.03 * organ.length(), {}};
  const Vec3d pull = noise(0.2 * organ.length());
  const Vec3d from = organ.mesh.points.col(vertex()), to = organ.mesh.points.col(vertex());
  for (double t = 0; t <= duration; t += frame) {
    const double s = t / duration;
    grasp.path.push_back({t, std::sin(3 * s) * pull + noise(t > 0 ? 0.003 * organ.length() : 0)});
    cautery.path.push_back({t, from + s * (to - from) + noise(0.01 * organ.length())});
  }
  setup.grasps.push_back(std::move(grasp));
  setup.cauteries.push_back(std::move(cautery));
  return setup;
}

// Finite; cut as if built so; saved, restored and going on with the same bits.
void check(World<float>& world, const Setup& setup, Tally& tally) {
  ++tally.checks;
  if (!world.state().u.allFinite() || !world.state().v.allFinite())
    throw WrongResult("soak: the state is not finite");
  tally.largest_difference = std::max(tally.largest_difference, compare_with_rebuilt(world).largest());
  if (!(tally.largest_difference < 1e-3))
    throw WrongResult("soak: the cut world differs from one built afresh by " +
                      std::to_string(tally.largest_difference));
  World<float> other(setup, 2);
  other.restore(world.save());
  world.advance(1.0 / 60);
  other.advance(1.0 / 60);
  if (digest(world) != digest(other)) throw WrongResult("soak: a restored world goes on with other bits");
}

void play(const Setup& setup, Clock::time_point& last_check, Tally& tally) {
  World<float> world(setup);
  ++tally.gestures;
  while (world.time() < 2) {
    const Report report = world.advance(1.0 / 60);
    ++tally.frames;
    tally.steps += report.steps;
    tally.reruns += report.reruns;
    tally.removed += report.tets_removed;
    tally.smallest_ratio = std::min(tally.smallest_ratio, report.smallest_volume_ratio);
    if (!report.ok) {
      ++tally.stopped;
      std::printf("stopped: %s\n", report.conditions.back().text.c_str());
      return;
    }
    if (seconds_since(last_check) < 1) continue;
    check(world, setup, tally);
    last_check = Clock::now();
  }
}

}  // namespace

void bench_soak(const Options& options) {
  begin_results(options.output, "soak");
  soak_sessions(options);
  const std::vector<stress::Subject> organs = stress::organs(false);
  std::mt19937 random(1);
  Tally tally;
  const Clock::time_point start = Clock::now();
  Clock::time_point last_check = start;
  const double minutes = options.quick ? 0.1 : options.minutes;
  while (seconds_since(start) < 60 * minutes)
    play(gesture(organs[std::size_t(tally.gestures) % organs.size()], random), last_check, tally);
  char line[400];
  std::snprintf(
      line, sizeof line,
      "soak: %.1f min, %ld gestures, %ld frames, %ld steps, %ld tetrahedra removed, %ld frames run again, "
      "%ld gestures stopped with a report; %ld checks held (cut = built afresh to %.1e); smallest det F %.2g",
      seconds_since(start) / 60, tally.gestures, tally.frames, tally.steps, tally.removed, tally.reruns,
      tally.stopped, tally.checks, tally.largest_difference, tally.smallest_ratio);
  std::printf("%s\n", line);
  io::write_file(options.output / "soak.txt", std::string(line) + "\n");
}

}  // namespace lobe::bench
