// Implicit dynamics of a body in motion: generalised-α steps, whose accelerations and tangent follow edits
// (theory, section 13).
#pragma once

#include <functional>

#include "lobe/solve/implicit_step.h"
#include "lobe/time/dynamics.h"

namespace lobe {

class ImplicitDynamics {
 public:
  explicit ImplicitDynamics(double spectral_radius);

  // Takes one step [s]. False if it was not solved; then nothing has moved. given(item, time): the
  // displacement of a held vertex [m].
  using PrescribedMotion = std::function<Vec3d(const HeldVertices::Held& item, double time)>;
  bool step(Dynamics<double>& body, double dt, const PrescribedMotion& prescribed);

  // Part of a checkpoint: accelerations [m/s²], 3 × #vertices; empty if they are to be computed from the
  // forces.
  Mat3X<double> acceleration(const Model& model) const;
  void set_acceleration(const Model& model, const Mat3X<double>& acceleration);

 private:
  bool is_current(const Revisions& now) const {
    return !is_new_ && at_.structure == now.structure && at_.inertia == now.inertia &&
           at_.replaced == now.replaced;
  }

  ImplicitStep step_;
  Mat3X<double> acceleration_;  // [m/s²]
  Revisions at_;                // revisions to which they belong
  bool is_new_ = true;
  bool has_tangent_ = false;
};

}  // namespace lobe
