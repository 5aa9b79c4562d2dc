// One schedule played by one model: how long it takes, and where the vertices were.
#pragma once

#include <string>
#include <vector>

#include "lobe/scene/scene.h"

namespace lobe::bench {

// All runs of a scene advance in the same frames, about as long as the scene's, and are sampled at the same
// times, equally spaced, the last at the end.
struct Schedule {
  int frames = 0;  // a multiple of the number of samples
  int samples = 0;
  double frame = 0;  // [s]
  double duration() const { return frames * frame; }
};
Schedule schedule_of(const Time& time, int samples = 10);

struct Way {
  Precision precision = Precision::double_precision;
  double safety = 0.9;  // of the time step
  int threads = 1;
};

using Samples = std::vector<Mat3X<double>>;  // displacements [m], one per sample time

struct Played {
  bool to_the_end = true;
  std::string status;          // "done", with a remark on trouble; or when and why it ended
  double dt = 0;               // mean time step [s]
  double wall_per_s = 0;       // [s] per simulated second, without set-up and sampling
  std::vector<double> frames;  // [s] of each
  Samples samples;             // those before the end
};

// On one thread it is that thread's processor time that is taken. Runs below 0.1 s are played three times,
// and the shortest time counts. With `is_corrected`, watches estimate the errors of reduced regions and of
// selective masses, and correct them above 2 %; their time counts.
Played play(const Setup& setup, const Schedule& schedule, const Way& way, bool is_corrected = false);

// Plays it once, for a reference. Throws WrongResult if it does not run to its end.
Samples play_reference(const Setup& setup, const Schedule& schedule, double safety, int threads);

}  // namespace lobe::bench
