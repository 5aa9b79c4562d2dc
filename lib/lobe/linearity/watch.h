// LinearityWatch estimates the error of linear regions while a world runs, and corrects it if asked (theory,
// section 15). Zones of tensor-mass regions become non-linear, and linear again. Pre-computed regions are
// relinearised about the present state, and expanded where that is not enough.
//
//   LinearityWatch<float> watch(world, grasps, {.tolerance = 0.02, .correct = true});
//   world.advance(1.0 / 30);
//   const LinearityReport report = watch.look(world);
#pragma once

#include <functional>
#include <future>
#include <memory>

#include "lobe/linearity/command_sink.h"
#include "lobe/linearity/defect.h"
#include "lobe/linearity/influence.h"
#include "lobe/linearity/watch_report.h"

namespace lobe {

struct LinearityReport : WatchReport {  // its error is 0 while the pre-computed region is expanded
  double worst = 0;                     // the largest mean displacement error of a zone, that of `place` [m]
  Index to_nonlinear = 0, to_linear = 0;  // tetrahedra that changed their model
  bool is_expanded = false;               // whether the pre-computed region is

  // Counts by the keys of a run's report, which has the sums over its frames.
  static constexpr auto counts =
      std::tuple(std::pair("frames_expanded", &LinearityReport::is_expanded),
                 std::pair("tetrahedra_to_nonlinear", &LinearityReport::to_nonlinear),
                 std::pair("tetrahedra_to_linear", &LinearityReport::to_linear));
};

struct LinearityOptions {
  double tolerance = 0.02;
  bool correct = false;
  RegionModel linear = RegionModel::tensor_mass;  // model of zones that become linear
  Index zones = 0;                                // 0: usual_zone_count()
  int recover_every = 12;  // frames between estimates that must recover a pre-computed interior
  Index most_tets = 600;   // most tetrahedra that change their model in one frame
  std::function<void(const LinearityReport&)> on_exceeded = {};
};

template <class Real>
class LinearityWatch {
 public:
  using Report = LinearityReport;

  // Costs one factor and three solves per zone. `grasps` are the vertices of the setup's grasps.
  LinearityWatch(const World<Real>& world, const std::vector<std::vector<Index>>& grasps,
                 LinearityOptions options);
  LinearityWatch(const LinearityWatch&) = delete;
  LinearityWatch& operator=(const LinearityWatch&) = delete;

  // Call it at the start, and after each frame.
  // - An estimate costs one small dense product, and with a pre-computed region the recovery of its interior.
  // - With a condensed region every 12th frame has an estimate (recover_every), or every 3rd to 6th if the
  //   region may be expanded. Otherwise every frame has one, or every 2nd while the error is small. In frames
  //   without an estimate look() returns the last report, with the present time.
  // - With `correct`, an expandable region is expanded after a cut, a grasp or a release, whatever its error.
  // - A background thread finds how cuts change the influence of zones. The result is used from a fixed
  //   simulated time on.
  LinearityReport look(World<Real>& world) { return look(world, sink_of(world)); }
  LinearityReport look(World<Real>& world, const CommandSink& send);

  // Mean displacement error per zone [m] of the last estimate, 3 × #zones; empty before the first one.
  const Mat3X<double>& zone_errors() const { return zone_errors_; }
  const Zones& zones() const { return zones_; }

  double looking_seconds() const { return looking_seconds_; }  // total, corrections left out

 private:
  HeldVertices boundary_of(const World<Real>& world) const;
  bool follow_edits(const World<Real>& world);
  bool follow_cuts(const World<Real>& world);
  void find_shares(const Elements& elements);
  bool hold(const HeldVertices& held);
  bool may_skip(const World<Real>& world, bool was_disturbed) const;
  LinearityReport report_without_estimate(const World<Real>& world);
  bool may_expand(const World<Real>& world) const;
  Defects defects(const World<Real>& world, const Mat3X<double>& u, bool all) const;
  double inertia_error_of(const World<Real>& world) const;
  void place_worst(const Elements& elements, const Eigen::VectorXd& error, LinearityReport& report) const;
  void correct_precomputed(const World<Real>& world, const CommandSink& send, double estimate,
                           LinearityReport& report);
  double relative(const Eigen::VectorXd& error) const;
  void correct(const World<Real>& world, const CommandSink& send, const Defects& defects,
               Eigen::VectorXd error, LinearityReport& report);
  void move(const World<Real>& world, const CommandSink& send, Index zone, RegionModel model,
            LinearityReport& report);

  LinearityOptions options_;
  std::vector<std::vector<Index>> grasps_;
  Zones zones_;
  Mat3X<double> zone_errors_;
  MeanDefects defects_;
  std::unique_ptr<Influence> influence_;
  std::future<std::unique_ptr<Influence>> next_influence_;
  double influence_due_ = 0;             // [s]
  bool influence_is_stale_ = false;      // cuts came that not even the next one knows
  std::vector<double> share_;            // share of each zone's volume that is linear
  bool any_precomputed_ = false;         // tetrahedra
  std::vector<int> frames_near_linear_;  // frames since which each zone could have been linear
  std::vector<double> tet_volume_;       // volume of each tetrahedron at rest [m³]
  std::vector<double> volume_;           // volume around each vertex [m³]
  double density_ = 1;                   // mean [kg/m³]
  std::vector<Index> holding_;           // grasps that hold
  double time_ = 0;                      // time of the last estimate [s]
  int frames_condensable_ = 0;           // frames since which the region could have been condensed
  EditReader edits_;
  double largest_ = 0;  // largest norm so far [m^2.5]
  double looking_seconds_ = 0;
  int looks_ = 0;
  LinearityReport last_;
};

extern template class LinearityWatch<float>;
extern template class LinearityWatch<double>;

}  // namespace lobe
