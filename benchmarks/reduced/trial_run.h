// The gestures of `lobe bench reduced`, and a trial body that plays them.
#pragma once

#include <string>

#include "benchmarks/reduced/trial_body.h"

namespace lobe::reduced {

struct Grasp {
  Vec3d centre;
  double radius;                               // [m]
  std::vector<std::pair<double, Vec3d>> path;  // times [s], displacements [m]; lets go at the end
  Vec3d at(double time) const;
};
struct Gesture {
  std::string name;
  double duration = 0;  // [s]
  std::vector<Grasp> grasps;
};
struct Organ {
  std::string name;
  bool (*is_held)(const Vec3d& X);
  std::vector<Gesture> gestures;
};
Organ liver();
Organ kidney();

// What moves by itself: the vertices within `margin` of a sphere that takes hold, from then until `after` it
// lets go, and all for `burst` after each release. Nothing is declared.
struct Policy {
  bool is_reduced = true;
  double margin = 0.005;  // [m]
  double after = 0.25;    // [s]
  double burst = 0;       // [s]
};

constexpr double frame_duration = 0.05;  // [s]

struct Played {
  std::vector<Eigen::MatrixXf> frames;  // displacements of the first vertices [m]
  double seconds = 0;                   // of processor time, changes of zones included
  double changing = 0, slowest = 0;     // of it: in changes; in the slowest frame [s]
  long steps = 0;
  double full_share = 0;  // mean over steps
  TransitionCount transitions;
};

// `safety`: of the limit, which is found anew three times a frame; `compared`: how many vertices are kept.
template <class Real>
Played play(const Body& body, const Organ& organ, const Gesture& gesture, const TrialSettings& settings,
            const Policy& policy, double safety, Index compared);

struct Errors {  // L2 over all vertices, relative to the largest norm of the reference so far
  double largest = 0, mean = 0, largest_at = 0;  // at: [s]
  int above = 0;                                 // frames above 2 %
};
Errors compare(const Played& played, const Played& reference);

std::vector<std::uint8_t> held_vertices(const Body& body, const Organ& organ);

}  // namespace lobe::reduced
