#include "lobe/linearity/proposal.h"

#include <algorithm>
#include <limits>

#include "lobe/condense/interface_size.h"
#include "lobe/condense/narrow_interface.h"
#include "lobe/condense/supports.h"
#include "lobe/error.h"
#include "lobe/linearity/defect.h"
#include "lobe/linearity/influence.h"
#include "lobe/linearity/select_zones.h"
#include "lobe/linearity/trials.h"
#include "lobe/text.h"

namespace lobe {
namespace {

class Proposer {
 public:
  Proposer(const Setup& setup, std::vector<Gesture> gestures, const ProposalOptions& options)
      : options_(options),
        setup_(all_nonlinear(setup)),
        gestures_(std::move(gestures)),
        elements_(setup_),
        zones_(elements_, options.zones > 0 ? options.zones : usual_zone_count(setup.mesh.tet_count())) {}

  Proposal propose() {
    proposal_.region_of = setup_.region_of;
    if (gestures_.empty()) gestures_ = usual_gestures(setup_);
    try {
      solve();
      if (trials_.empty()) throw InputError("gestures", "none has an equilibrium");
      predict();
      cost_ = options_.cost ? *options_.cost : measure_step_cost(setup_, zones_, options_.in_double);
      try_variants();
    } catch (const InputError& error) {
      nothing_linear(error.what());
    }
    progress(1);
    return std::move(proposal_);
  }

 private:
  struct Variant {
    std::vector<RegionModel> region_of;
    std::vector<double> predicted, measured;  // errors, per trial
    double cost = std::numeric_limits<double>::max();
  };

  static Setup all_nonlinear(Setup setup) {
    setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
    return setup;
  }
  void progress(double fraction) const {
    if (options_.progress) options_.progress(fraction);
  }
  void nothing_linear(const std::string& why) { proposal_.notes.push_back("nothing is linear: " + why); }
  void solve() {
    trials_ = solve_trials(setup_, gestures_, [&](std::size_t g, const StaticResult& found) {
      GestureOutcome& outcome = proposal_.gestures.emplace_back();
      outcome.name = gestures_[g].name;
      outcome.reached = found.load_fraction;
      if (!found.converged)
        proposal_.notes.push_back("gesture \"" + outcome.name + "\" was followed to " +
                                  rounded(100 * found.load_fraction) + " %: " + found.reason);
      progress(0.4 * double(g + 1) / double(gestures_.size()));
    });
  }

  // To first order, from the exact solutions.
  void predict() {
    std::vector<std::vector<Index>> grasps;
    for (const Gesture& gesture : gestures_) grasps.push_back(gesture.vertices);
    Influence influence(elements_, zones_, held_by(setup_.prescribed), grasps);
    for (const Trial& trial : trials_) {
      const bool holds = !gestures_[trial.gesture].displacements.empty();
      influence.hold(holds ? std::vector<Index>{static_cast<Index>(trial.gesture)} : std::vector<Index>{});
      const Defects defects = exact_defects(elements_, zones_, trial.u);
      TrialError& error = errors_.emplace_back();
      error.norm = trial.norm;
      error.contributions.resize(3 * zones_.count(), zones_.count());
      for (Index z = 0; z < zones_.count(); ++z)
        error.contributions.col(z) = influence.displacement(z, defects.col(z));
    }
  }

  std::vector<RegionModel> regions_of(const std::vector<char>& linear, bool condensed) const {
    Elements tagged = elements_;
    std::vector<Side> sides;
    for (std::size_t t = 0; t < zones_.of.size(); ++t)
      sides.push_back(linear[std::size_t(zones_.of[t])] ? Side::linear : Side::nonlinear);
    if (condensed) sides = with_narrow_interface(setup_.mesh, may_shrink(linear, std::move(sides)));
    for (std::size_t t = 0; t < sides.size(); ++t)
      if (sides[t] == Side::linear)
        tagged.region_of[t] = condensed ? RegionModel::precomputed : RegionModel::tensor_mass;
    if (condensed)
      for (Index t : unsupported_tets(tagged, held_by(setup_.prescribed)))
        tagged.region_of[t] = RegionModel::nonlinear;
    return tagged.region_of;
  }

  // Within the linear zones at the border, the region may end wherever its interface is narrowest.
  std::vector<Side> may_shrink(const std::vector<char>& linear, std::vector<Side> sides) const {
    std::vector<char> at_border(linear.size(), 0);
    for (Index v = 0; v < elements_.topology.vertex_count(); ++v) {
      const auto around = elements_.topology.around(v);
      const auto is_linear = [&](Index t) { return linear[std::size_t(zones_.of[std::size_t(t)])] != 0; };
      if (std::all_of(around.begin(), around.end(), is_linear)) continue;
      for (Index t : around) at_border[std::size_t(zones_.of[std::size_t(t)])] = 1;
    }
    for (std::size_t t = 0; t < sides.size(); ++t)
      if (sides[t] == Side::linear && at_border[std::size_t(zones_.of[t])]) sides[t] = Side::either;
    return sides;
  }

  // Measured errors correct the predictions, and the choice is made again.
  Variant find(bool condensed, double from, double to) {
    constexpr int tries = 4;
    for (TrialError& error : errors_) error.scale = 1;
    Variant best;
    for (int i = 0; i < tries; ++i) {
      progress(from + (to - from) * i / tries);
      const std::vector<char> linear =
          select_zones(elements_, zones_, errors_, options_.tolerance, cost_, condensed);
      if (std::count(linear.begin(), linear.end(), 1) == 0) break;
      Variant variant;
      variant.region_of = regions_of(linear, condensed);
      bool fits = true;
      double worst = 0;
      for (std::size_t i_trial = 0; i_trial < trials_.size(); ++i_trial) {
        const double predicted = errors_[i_trial].of(zones_, linear),
                     measured = static_error(variant.region_of, trials_[i_trial]);
        variant.predicted.push_back(predicted);
        variant.measured.push_back(measured);
        worst = std::max(worst, measured);
        fits = fits && measured <= options_.tolerance;
        errors_[i_trial].scale *= std::clamp(1.05 * measured / predicted, 0.5, 10.0);
      }
      if (fits) variant.cost = seconds_of(variant.region_of);
      if (variant.cost < best.cost) best = std::move(variant);
      if (fits && (i > 0 || worst > 0.8 * options_.tolerance)) break;
    }
    return best;
  }

  Setup with(const std::vector<RegionModel>& region_of) const {
    Setup setup = setup_;
    setup.region_of = region_of;
    return setup;
  }

  double seconds_of(const std::vector<RegionModel>& region_of) const {
    if (options_.cost) return predicted_seconds(region_of);
    try {
      return step_seconds(with(region_of), options_.in_double);
    } catch (const InputError&) {  // it cannot be condensed
      return std::numeric_limits<double>::max();
    }
  }

  double predicted_seconds(const std::vector<RegionModel>& region_of) const {
    const auto count = [&](RegionModel model) {
      return double(std::count(region_of.begin(), region_of.end(), model));
    };
    Elements tagged = elements_;
    tagged.region_of = region_of;
    return cost_.of(count(RegionModel::nonlinear), count(RegionModel::tensor_mass),
                    interface_size(tagged, RegionModel::tensor_mass).vertices,
                    3.0 * interface_size(tagged, RegionModel::precomputed).vertices);
  }

  // Measures all variants once more, in turn with the body that is all non-linear, because they were found at
  // different times.
  void try_variants() {
    std::vector<Variant> found;
    const double middle = options_.tensor_mass ? 0.7 : 0.45;
    if (options_.tensor_mass) found.push_back(find(false, 0.45, options_.condense ? middle : 1));
    if (options_.condense) found.push_back(find(true, middle, 1));
    std::erase_if(found, [](const Variant& variant) { return variant.region_of.empty(); });
    const std::string error = "the error below " + rounded(100 * options_.tolerance) + " %";
    if (found.empty()) return nothing_linear("no zone keeps " + error);
    double nonlinear = cost_.nonlinear * double(setup_.mesh.tet_count());
    if (!options_.cost) {
      std::vector<Setup> setups{setup_};
      for (const Variant& variant : found) setups.push_back(with(variant.region_of));
      const std::vector<double> seconds = step_seconds(setups, options_.in_double);
      nonlinear = seconds[0];
      for (std::size_t i = 0; i < found.size(); ++i) found[i].cost = seconds[i + 1];
    }
    const auto best = std::min_element(found.begin(), found.end(),
                                       [](const Variant& a, const Variant& b) { return a.cost < b.cost; });
    if (best->cost >= nonlinear)
      return nothing_linear("the regions that keep " + error + " are too small to make a step faster");
    describe(*best, nonlinear);
  }

  void describe(const Variant& best, double nonlinear) {
    proposal_.region_of = best.region_of;
    proposal_.measured_speedup = nonlinear / best.cost;
    double linear = 0, all = 0;
    for (Index t = 0; t < setup_.mesh.tet_count(); ++t) {
      const double volume = elements_.volume(t);
      all += volume;
      if (best.region_of[t] != RegionModel::nonlinear) linear += volume;
    }
    proposal_.linear_share = linear / all;
    proposal_.predicted_speedup = nonlinear / predicted_seconds(best.region_of);
    for (std::size_t i = 0; i < trials_.size(); ++i) {
      GestureOutcome& outcome = proposal_.gestures[trials_[i].gesture];
      outcome.predicted = best.predicted[i];
      outcome.measured = best.measured[i];
    }
  }

  const ProposalOptions& options_;
  Setup setup_;
  std::vector<Gesture> gestures_;
  Elements elements_;
  Zones zones_;
  std::vector<Trial> trials_;
  std::vector<TrialError> errors_;  // per trial
  StepCost cost_;
  Proposal proposal_;
};

// The inside of a condensed region bears no load that turns, and nothing can pull at it.
bool may_be_condensed(const Setup& setup) { return setup.pressures.empty() && !setup.any_force(); }

}  // namespace

Proposal propose_regions(const Setup& setup, std::vector<Gesture> gestures, const ProposalOptions& options) {
  if (!(options.tolerance > 0 && options.tolerance < 1))
    throw InputError("tolerance", rounded(options.tolerance) + ", must be above 0 and below 1");
  ProposalOptions possible = options;
  possible.condense = options.condense && may_be_condensed(setup);
  return Proposer(setup, std::move(gestures), possible).propose();
}

Proposal propose_regions_to_correct(const Setup& setup, const std::vector<Gesture>& gestures,
                                    ProposalOptions options) {
  // Allowed are three times the tolerance, but at most 7 % of the displacement. With more, so much of the
  // body would be condensed that most of what moves would be its interface.
  constexpr double correctable = 3, most = 0.07;
  const double asked = options.tolerance;
  if (options.condense && may_be_condensed(setup) && setup.precomputed_frame == RegionFrame::fixed &&
      !any_nodal_pressure(setup.materials)) {
    options.tolerance = std::max(asked, std::min(correctable * asked, most));
    options.tensor_mass = false;
    const Proposal proposal = propose_regions(setup, gestures, options);
    if (std::count(proposal.region_of.begin(), proposal.region_of.end(), RegionModel::precomputed) > 0)
      return proposal;
    options.tolerance = asked;
    options.tensor_mass = true;
  }
  options.condense = false;
  return propose_regions(setup, gestures, options);
}

}  // namespace lobe
