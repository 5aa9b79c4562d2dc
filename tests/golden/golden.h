// Runs whose bits are kept: the digests of displacements, velocities and time at ten times of each
// (digests.txt).
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lobe/file/sealed_file.h"
#include "lobe/sim/validate.h"
#include "lobe/sim/world.h"

namespace lobe::test {

constexpr int golden_times = 10;
using Digests = std::vector<std::uint64_t>;

struct GoldenRun {
  std::string name;
  std::function<Digests(int threads)> play;
};

std::vector<GoldenRun> shipped_scenes();  // those of data/scenes
std::vector<GoldenRun> option_scenes();   // small bodies, one for each option and what goes with it

// Of displacements, velocities and time. What the digests of recordings are made by may change; this does
// not.
template <class Real>
std::uint64_t golden_digest(World<Real>& world) {
  const StateView<Real> state = world.state();
  const auto values = [](const auto& matrix) { return std::span(matrix.data(), std::size_t(matrix.size())); };
  const std::uint64_t u = io::digest_of(values(state.u)), v = io::digest_of(values(state.v), u);
  return io::digest_of(std::span(&state.time, 1), v);
}

// Plays so many frames. `begin(world)` is called once; what it returns is called with the number of each
// frame before that.
template <class Real, class Begin>
Digests play_golden(const Setup& setup, int threads, int frames, double frame, Begin&& begin) {
  World<Real> world(setup, threads);
  Digests digests;
  auto before_frame = begin(world);
  for (int i = 0; i < frames; ++i) {
    before_frame(i);
    world.advance(frame);
    if ((i + 1) * golden_times / frames > i * golden_times / frames) digests.push_back(golden_digest(world));
  }
  validate(world);
  return digests;
}

// Both precisions of a run.
template <class Begin>
void add_golden(std::vector<GoldenRun>& runs, const std::string& name, const Setup& setup, int frames,
                double frame, Begin begin) {
  runs.push_back({name + ", single",
                  [=](int threads) { return play_golden<float>(setup, threads, frames, frame, begin); }});
  runs.push_back({name + ", double",
                  [=](int threads) { return play_golden<double>(setup, threads, frames, frame, begin); }});
}

}  // namespace lobe::test
