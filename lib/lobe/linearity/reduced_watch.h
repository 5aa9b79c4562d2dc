// ReducedWatch estimates the error of reduced regions while a world runs, and corrects it if asked: vertices
// become full for a while where most of it is made (theory, section 18). Otherwise it changes nothing in the
// world.
//
//   ReducedWatch<float> watch(world, {.tolerance = 0.02, .correct = true});
//   world.advance(1.0 / 30);
//   const ReducedReport report = watch.look(world);
#pragma once

#include <functional>
#include <future>
#include <optional>

#include "lobe/linearity/command_sink.h"
#include "lobe/linearity/error_equation.h"
#include "lobe/linearity/watch_report.h"

namespace lobe {

struct ReducedReport : WatchReport {  // `place`: the vertex with the largest error
  Index to_full = 0;                  // vertices that it has made full
  static constexpr auto counts = std::make_tuple(std::pair("vertices_to_full", &ReducedReport::to_full));
};

struct ReducedOptions {
  double tolerance = 0.02;
  bool correct = false;
  std::function<void(const ReducedReport&)> on_exceeded = {};
};

template <class Real>
class ReducedWatch {
 public:
  using Report = ReducedReport;
  static constexpr int frames_between = 2;  // frames between two estimates

  // If the world has no reduced region then, every error is 0, and nothing is computed.
  ReducedWatch(const World<Real>& world, ReducedOptions options);

  // Call it at the start, and after each frame. An estimate costs four evaluations of all tetrahedra and a
  // solution of few equations. The error counts from the first call, and from where the world was restored.
  ReducedReport look(World<Real>& world) { return look(world, sink_of(world)); }
  ReducedReport look(World<Real>& world, const CommandSink& send);

  // The error of each known vertex at the last estimate [m]; none without a reduced region.
  Mat3X<double> vertex_errors(const World<Real>& world) const;
  double looking_seconds() const { return looking_seconds_; }  // total

 private:
  void begin_again(const World<Real>& world);
  void follow_edits(const World<Real>& world);
  void estimate(World<Real>& world, double h);
  void measure(World<Real>& world);
  std::vector<Index> where_most_is_made(const World<Real>& world) const;

  ReducedOptions options_;
  std::optional<ErrorEquation> equation_;
  std::future<TwoGrid> next_grid_;  // grid for the mesh as it was when it was begun
  double grid_due_ = 0;             // [s]
  bool grid_is_stale_ = false;
  EditReader edits_;
  bool begins_ = true;  // whether the error counts from here
  int looks_ = -1;
  double time_ = 0;     // time of the last estimate [s]
  double largest_ = 0;  // largest norm of the displacement so far [√kg m]
  ReducedReport last_;
  double before_ = 0;  // estimate before the last
  double looking_seconds_ = 0;
};

extern template class ReducedWatch<float>;
extern template class ReducedWatch<double>;

}  // namespace lobe
