// Collects for the report what the watches find while a scene runs: errors of linear regions and of selective
// masses that lobe has chosen, and of reduced regions.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tuple>
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

// What one watch has reported, if there is one.
template <class Watch>
class Watched {
 public:
  template <class... Arguments>
  void begin(Arguments&&... arguments) {
    watch_.emplace(std::forward<Arguments>(arguments)...);
    visit_counts([&](const char* key, auto) { counts_[key] = 0; });
  }
  bool any() const { return watch_.has_value(); }

  template <class Real>
  void look(World<Real>& world, CommandRecorder<Real>* recorded) {
    if (!watch_) return;
    if (!series_.empty())
      ++frames_[std::to_string(world.body().inertia.degree())];  // degree of the frame before
    const auto seen = recorded ? watch_->look(world, sink_of(*recorded)) : watch_->look(world);
    if (seen.error > worst_.error) worst_ = seen;
    exceeded_ += seen.exceeded;
    visit_counts([&](const char* key, auto member) { counts_[key] += static_cast<long long>(seen.*member); });
    series_.push_back({{"time", seen.time}, {"error", seen.error}});
    if constexpr (has_degrees) series_.back()["degree"] = seen.degree;
  }

  // Empty if no error was above the tolerance.
  std::string warning(const std::string& of_what, double tolerance, const std::string& remedy) const {
    if (worst_.error <= tolerance) return "";
    return "the error of " + of_what + " was estimated at up to " + rounded(100 * worst_.error) + " % at " +
           rounded(worst_.time) + " s, most " + place_in_words(worst_.place) + "; " + remedy;
  }
  nlohmann::ordered_json json() const {
    nlohmann::ordered_json all{{"worst_error", worst_.error},
                               {"worst_time", worst_.time},
                               {"worst_place", {worst_.place[0], worst_.place[1], worst_.place[2]}},
                               {"frames_exceeded", exceeded_}};
    visit_counts([&](const char* key, auto) { all[key] = counts_.at(key); });
    if constexpr (has_degrees) all["frames_by_degree"] = frames_;
    all["looking_s"] = watch_->looking_seconds();
    all["series"] = series_;
    return all;
  }

 private:
  using Report = typename Watch::Report;
  static constexpr bool has_degrees = requires(Report report) { report.degree; };
  template <class Visit>
  static void visit_counts(Visit&& visit) {
    std::apply([&](const auto&... count) { (visit(count.first, count.second), ...); }, Report::counts);
  }

  std::optional<Watch> watch_;
  Report worst_;
  int exceeded_ = 0;
  std::map<std::string, long long> counts_;
  std::map<std::string, int> frames_;
  nlohmann::ordered_json series_ = nlohmann::ordered_json::array();
};

template <class Real>
class WatchResults {
 public:
  WatchResults(World<Real>& world, const Scene& scene, const Resolved& resolved)
      : tolerance_(scene.auto_regions ? scene.auto_regions->tolerance : 0),
        corrects_(scene.auto_regions && scene.auto_regions->correct),
        reduced_tolerance_(scene.reduced_tolerance().value_or(ReducedOptions{}.tolerance)),
        corrects_reduced_(scene.reduced_tolerance().has_value()) {
    if (world.body().regions.any_reduced())
      reduced_.begin(world, ReducedOptions{reduced_tolerance_, corrects_reduced_});
    else if (scene.corrects_masses())
      masses_.begin(world, tolerance_);
    else if (scene.auto_regions)
      linear_.begin(world, grasped(resolved.setup), LinearityOptions{tolerance_, corrects_});
  }

  void look(World<Real>& world, CommandRecorder<Real>* recorded) {
    linear_.look(world, recorded);
    masses_.look(world, recorded);
    reduced_.look(world, recorded);
  }

  std::vector<std::string> warnings() const {
    std::vector<std::string> found{
        linear_.warning("linear regions", tolerance_,
                        std::string("declare that gesture") + (corrects_ ? "" : ", or set \"correct\"")),
        masses_.warning("selective masses", tolerance_, "a lower selective_mass or tolerance may help"),
        reduced_.warning("reduced regions", reduced_tolerance_,
                         std::string("a smaller \"cell\", or \"nonlinear\" there, may help") +
                             (corrects_reduced_ ? "" : ", or a \"tolerance\" above which it is corrected"))};
    std::erase(found, "");
    return found;
  }
  void add_to(nlohmann::ordered_json& report, const nlohmann::ordered_json& transitions) const {
    if (linear_.any()) report["linearity"] = linear_.json();
    if (masses_.any()) report["selective_mass"] = masses_.json();
    if (!reduced_.any()) return;
    report["reduced"] = reduced_.json();
    report["reduced"]["transitions"] = transitions;
  }

 private:
  static std::vector<std::vector<Index>> grasped(const Setup& setup) {
    std::vector<std::vector<Index>> grasps;
    for (const GraspSetup& grasp : setup.grasps) {
      grasps.push_back(grasp.vertices);
      std::erase_if(grasps.back(), [&](Index v) { return v >= setup.mesh.vertex_count(); });
    }
    return grasps;
  }

  double tolerance_;
  bool corrects_;
  double reduced_tolerance_;  // above which there is a warning
  bool corrects_reduced_;
  Watched<LinearityWatch<Real>> linear_;
  Watched<MassWatch<Real>> masses_;
  Watched<ReducedWatch<Real>> reduced_;
};

}  // namespace lobe
