// Runs whose bits are kept: the digests of displacements, velocities and time at ten times of each
// (digests.txt).
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "lobe/file/sealed_file.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "lobe/sim/world.h"

namespace lobe::test {

constexpr int golden_times = 10;
using Digests = std::vector<std::uint64_t>;

struct GoldenRun {
  std::string name;
  std::function<Digests(int threads)> play;
  // The same run, which another world takes over at half time from a checkpoint. Null: something outside of
  // the world, whose state no checkpoint has, edits it.
  std::function<Digests(int threads)> take_over = {};
};

std::vector<GoldenRun> shipped_scenes();  // those of data/scenes
std::vector<GoldenRun> option_scenes();   // small bodies, one for each option and what goes with it
std::vector<GoldenRun> element_scenes();  // small bodies of smoothed tetrahedra, of further laws, that relax
std::vector<GoldenRun> term_scenes();     // small bodies that are sewn, tied, clipped, blown up

// Of displacements, velocities and time. What the digests of recordings are made by may change; this does
// not.
template <class Real>
std::uint64_t golden_digest(World<Real>& world) {
  const StateView<Real> state = world.state();
  const auto values = [](const auto& matrix) { return std::span(matrix.data(), std::size_t(matrix.size())); };
  const std::uint64_t u = io::digest_of(values(state.u)), v = io::digest_of(values(state.v), u);
  return io::digest_of(std::span(&state.time, 1), v);
}

enum class Course { straight, taken_over };  // by another world at half time, from a checkpoint

// Plays so many frames. `begin(world)` is called once per world; what it returns is called with the number of
// each frame before that.
template <class Real, class Begin>
Digests play_golden(const Setup& setup, int threads, int frames, double frame, Begin&& begin,
                    Course course = Course::straight) {
  auto world = std::make_unique<World<Real>>(setup, threads);
  Digests digests;
  std::function<void(int)> before_frame = begin(*world);
  for (int i = 0; i < frames; ++i) {
    if (course == Course::taken_over && 2 * i == frames) {
      auto other = std::make_unique<World<Real>>(setup, threads);
      before_frame = begin(*other);
      other->restore(world->save());
      world = std::move(other);
    }
    before_frame(i);
    world->advance(frame);
    if ((i + 1) * golden_times / frames > i * golden_times / frames) digests.push_back(golden_digest(*world));
  }
  validate(*world);
  return digests;
}

template <class Real, class Begin>
GoldenRun golden_run(const std::string& name, const Setup& setup, int frames, double frame, Begin begin) {
  const auto play = [=](Course course) {
    return [=](int threads) { return play_golden<Real>(setup, threads, frames, frame, begin, course); };
  };
  return {name + (std::is_same_v<Real, float> ? ", single" : ", double"), play(Course::straight),
          play(Course::taken_over)};
}

// Both precisions of a run.
template <class Begin>
void add_golden(std::vector<GoldenRun>& runs, const std::string& name, const Setup& setup, int frames,
                double frame, Begin begin) {
  runs.push_back(golden_run<float>(name, setup, frames, frame, begin));
  runs.push_back(golden_run<double>(name, setup, frames, frame, begin));
}

// The same where `begin` makes a watch, which has a state of its own.
template <class Begin>
void add_watched(std::vector<GoldenRun>& runs, const std::string& name, const Setup& setup, int frames,
                 double frame, Begin begin) {
  add_golden(runs, name, setup, frames, frame, begin);
  for (std::size_t i = runs.size() - 2; i < runs.size(); ++i) runs[i].take_over = {};
}

}  // namespace lobe::test
