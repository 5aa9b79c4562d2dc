// MassWatch estimates the error of selective masses while a world runs, and chooses their degree (theory,
// section 15). The degree is high while the body moves slowly, low while it is cut. Masses are lumped in the
// frame of a grasp or a release.
//
//   setup.selective_mass = 12;
//   MassWatch<float> watch(world, 0.02);
//   world.advance(1.0 / 30);
//   const MassReport report = watch.look(world);
#pragma once

#include <functional>
#include <limits>

#include "lobe/linearity/command_sink.h"
#include "lobe/linearity/watch_report.h"

namespace lobe {

struct MassReport : WatchReport {  // `place`: the vertex that accelerated most when the error was made
  int degree = 1;                  // degree from now on
  static constexpr auto counts = std::tuple();
};

template <class Real>
class MassWatch {
 public:
  using Report = MassReport;
  using OnExceeded = std::function<void(const MassReport&)>;

  // Finds the lowest mode of the body at rest, by one sparse factor. If nothing holds the body, masses stay
  // lumped.
  MassWatch(World<Real>& world, double tolerance, OnExceeded on_exceeded = {});

  // Call it at the start, and after each frame. Costs two norms over all vertices, and after a frame with
  // lumped masses one SelectiveMass::apply().
  MassReport look(World<Real>& world) { return look(world, sink_of(world)); }
  MassReport look(World<Real>& world, const CommandSink& send);

  double looking_seconds() const { return looking_seconds_; }  // total

 private:
  double slowness(const World<Real>& world, int degree) const;

  double tolerance_;
  OnExceeded on_exceeded_;
  double slowness_ = 0;    // error over acceleration, at the highest degree [s²]; infinite: never
  double decay_rate_ = 0;  // rate at which errors die away [1/s]
  double time_ = std::numeric_limits<double>::infinity();  // time of the last estimate [s]
  double error_ = 0;                                       // error that may be left [√kg m]
  Vec3d place_ = Vec3d::Zero();                            // place of that error
  double largest_ = 0;  // largest norm of the displacement so far [√kg m]
  EditReader edits_;
  double looking_seconds_ = 0;
};

// Accelerations of the last step; where masses were lumped, the part of them that this degree would leave.
template <class Real>
typename SelectiveMass<Real>::Acceleration smooth_acceleration(Dynamics<Real>& body, int degree);

extern template class MassWatch<float>;
extern template class MassWatch<double>;

}  // namespace lobe
