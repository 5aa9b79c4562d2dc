// Collects for the report what the watches find while a scene runs: errors of linear regions and of selective
// masses that lobe has chosen, and of reduced regions.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lobe/linearity/mass_watch.h"
#include "lobe/linearity/reduced_watch.h"
#include "lobe/linearity/watch.h"
#include "lobe/run/recording.h"
#include "lobe/scene/resolve.h"
#include "lobe/text.h"

namespace lobe {

inline std::string place_in_words(const Vec3d& place) {
  return "at [" + rounded(place[0]) + ", " + rounded(place[1]) + ", " + rounded(place[2]) + "] m";
}

// Collects what the watch of automatic linear regions reports.
template <class Real>
class LinearityResults {
 public:
  LinearityResults(const World<Real>& world, const Scene& scene, const Resolved& resolved) {
    if (!scene.auto_regions || scene.corrects_masses() || world.body().regions.any_reduced()) return;
    tolerance_ = scene.auto_regions->tolerance;
    corrects_ = scene.auto_regions->correct;
    std::vector<std::vector<Index>> grasps;
    for (const GraspSetup& grasp : resolved.setup.grasps) {
      grasps.push_back(grasp.vertices);
      std::erase_if(grasps.back(), [&](Index v) { return v >= resolved.setup.mesh.vertex_count(); });
    }
    watch_.emplace(world, grasps, LinearityOptions{tolerance_, corrects_});
  }

  void look(World<Real>& world, CommandRecorder<Real>* recorded) {
    if (!watch_) return;
    const LinearityReport seen = recorded ? watch_->look(world, sink_of(*recorded)) : watch_->look(world);
    expanded_ += seen.is_expanded;
    if (seen.error > worst_.error) worst_ = seen;
    exceeded_ += seen.exceeded;
    to_nonlinear_ += seen.to_nonlinear;
    to_linear_ += seen.to_linear;
    series_.push_back({{"time", seen.time}, {"error", seen.error}});
  }

  bool any() const { return watch_.has_value(); }
  std::string warning() const {
    if (worst_.error <= tolerance_) return "";
    return "the error of linear regions was estimated at up to " + rounded(100 * worst_.error) + " % at " +
           rounded(worst_.time) + " s, most " + place_in_words(worst_.place) + "; declare that gesture" +
           (corrects_ ? "" : ", or set \"correct\"");
  }
  nlohmann::ordered_json json() const {
    return {{"worst_error", worst_.error},
            {"worst_time", worst_.time},
            {"worst_place", {worst_.place[0], worst_.place[1], worst_.place[2]}},
            {"frames_exceeded", exceeded_},
            {"frames_expanded", expanded_},
            {"tetrahedra_to_nonlinear", to_nonlinear_},
            {"tetrahedra_to_linear", to_linear_},
            {"looking_s", watch_->looking_seconds()},
            {"series", series_}};
  }

 private:
  std::optional<LinearityWatch<Real>> watch_;
  double tolerance_ = 0;
  bool corrects_ = false;
  LinearityReport worst_;
  int exceeded_ = 0, expanded_ = 0;
  Index to_nonlinear_ = 0, to_linear_ = 0;
  nlohmann::ordered_json series_ = nlohmann::ordered_json::array();
};

// Collects what the watch of selective masses reports.
template <class Real>
class MassResults {
 public:
  MassResults(World<Real>& world, const Scene& scene) {
    if (!scene.corrects_masses() || world.body().regions.any_reduced()) return;
    tolerance_ = scene.auto_regions->tolerance;
    watch_.emplace(world, tolerance_);
  }

  void look(World<Real>& world, CommandRecorder<Real>* recorded) {
    if (!watch_) return;
    if (!series_.empty()) ++frames_[std::to_string(world.body().inertia.degree())];  // of the frame before
    const MassReport seen = recorded ? watch_->look(world, sink_of(*recorded)) : watch_->look(world);
    if (seen.error > worst_.error) worst_ = seen;
    exceeded_ += seen.exceeded;
    series_.push_back({{"time", seen.time}, {"error", seen.error}, {"degree", seen.degree}});
  }

  std::string warning() const {
    if (worst_.error <= tolerance_) return "";
    return "the error of selective masses was estimated at up to " + rounded(100 * worst_.error) + " % at " +
           rounded(worst_.time) + " s, most " + place_in_words(worst_.place) +
           "; a lower selective_mass or tolerance may help";
  }
  std::optional<nlohmann::ordered_json> json() const {
    if (!watch_) return {};
    return nlohmann::ordered_json{{"worst_error", worst_.error},
                                  {"worst_time", worst_.time},
                                  {"worst_place", {worst_.place[0], worst_.place[1], worst_.place[2]}},
                                  {"frames_exceeded", exceeded_},
                                  {"frames_by_degree", frames_},
                                  {"looking_s", watch_->looking_seconds()},
                                  {"series", series_}};
  }

 private:
  std::optional<MassWatch<Real>> watch_;
  double tolerance_ = 0;
  MassReport worst_;
  int exceeded_ = 0;
  std::map<std::string, int> frames_;
  nlohmann::ordered_json series_ = nlohmann::ordered_json::array();
};

// Collects what the watch of reduced regions reports.
template <class Real>
class ReducedResults {
 public:
  ReducedResults(const World<Real>& world, const Scene& scene)
      : tolerance_(scene.reduced_tolerance().value_or(ReducedOptions{}.tolerance)),
        corrects_(scene.reduced_tolerance().has_value()) {
    if (world.body().regions.any_reduced()) watch_.emplace(world, ReducedOptions{tolerance_, corrects_});
  }

  void look(World<Real>& world, CommandRecorder<Real>* recorded) {
    if (!watch_) return;
    const ReducedReport seen = recorded ? watch_->look(world, sink_of(*recorded)) : watch_->look(world);
    if (seen.error > worst_.error) worst_ = seen;
    exceeded_ += seen.exceeded;
    to_full_ += seen.to_full;
    series_.push_back({{"time", seen.time}, {"error", seen.error}});
  }

  std::string warning() const {
    if (worst_.error <= tolerance_) return "";
    return "the error of reduced regions was estimated at up to " + rounded(100 * worst_.error) + " % at " +
           rounded(worst_.time) + " s, most " + place_in_words(worst_.place) +
           "; a smaller \"cell\", or \"nonlinear\" there, may help" +
           (corrects_ ? "" : ", or a \"tolerance\" above which it is corrected");
  }
  std::optional<nlohmann::ordered_json> json() const {
    if (!watch_) return {};
    return nlohmann::ordered_json{{"worst_error", worst_.error},
                                  {"worst_time", worst_.time},
                                  {"worst_place", {worst_.place[0], worst_.place[1], worst_.place[2]}},
                                  {"frames_exceeded", exceeded_},
                                  {"vertices_to_full", to_full_},
                                  {"looking_s", watch_->looking_seconds()},
                                  {"series", series_}};
  }

 private:
  double tolerance_;  // above which there is a warning
  bool corrects_;
  std::optional<ReducedWatch<Real>> watch_;
  ReducedReport worst_;
  int exceeded_ = 0;
  Index to_full_ = 0;
  nlohmann::ordered_json series_ = nlohmann::ordered_json::array();
};

}  // namespace lobe
