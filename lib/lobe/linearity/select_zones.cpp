#include "lobe/linearity/select_zones.h"

#include <algorithm>
#include <limits>
#include <set>

namespace lobe {
namespace {

// Zones that change sides one at a time, with the error and the cost that follow from it.
class Selection {
 public:
  Selection(const Elements& elements, const Zones& zones, const std::vector<TrialError>& trials,
            const StepCost& cost, bool condensed)
      : zones_(zones), trials_(trials), cost_(cost), condensed_(condensed) {
    linear_.assign(std::size_t(zones.count()), 0);
    for (const TrialError& trial : trials)
      errors_.push_back(Eigen::VectorXd::Zero(trial.contributions.rows()));
    around_.assign(std::size_t(elements.topology.vertex_count()), 0);
    linear_around_ = around_;
    for (const std::vector<Index>& tets : zones.tets) {
      std::set<Index> vertices;
      for (Index t : tets)
        for (Index v : elements.topology.corners(t)) vertices.insert(v);
      for (Index v : vertices) ++around_[v];
      vertices_.emplace_back(vertices.begin(), vertices.end());
      nonlinear_tets_ += double(tets.size());
    }
  }

  const std::vector<char>& linear() const { return linear_; }
  double cost() const {
    return cost_.of(nonlinear_tets_, condensed_ ? 0 : linear_tets_, condensed_ ? 0 : interface_,
                    condensed_ ? 3 * interface_ : 0);
  }
  double error() const {
    double worst = 0;
    for (std::size_t g = 0; g < trials_.size(); ++g)
      worst = std::max(worst, trials_[g].relative(zones_, errors_[g]));
    return worst;
  }
  double error_with(Index zone) const {  // one more
    double worst = 0;
    for (std::size_t g = 0; g < trials_.size(); ++g)
      worst = std::max(worst, trials_[g].relative(zones_, errors_[g] + trials_[g].contributions.col(zone)));
    return worst;
  }
  void flip(Index zone) {
    const int sign = linear_[zone] ? -1 : 1;
    for (std::size_t g = 0; g < trials_.size(); ++g) errors_[g] += sign * trials_[g].contributions.col(zone);
    const auto is_shared = [&](Index v) { return linear_around_[v] > 0 && linear_around_[v] < around_[v]; };
    for (Index v : vertices_[zone]) {
      interface_ -= is_shared(v);
      linear_around_[v] += sign;
      interface_ += is_shared(v);
    }
    linear_tets_ += sign * double(zones_.tets[zone].size());
    nonlinear_tets_ -= sign * double(zones_.tets[zone].size());
    linear_[zone] ^= 1;
  }

 private:
  const Zones& zones_;
  const std::vector<TrialError>& trials_;
  const StepCost& cost_;
  bool condensed_;
  std::vector<char> linear_;
  std::vector<Eigen::VectorXd> errors_;        // per gesture
  std::vector<std::vector<Index>> vertices_;   // per zone
  std::vector<Index> around_, linear_around_;  // zones, per vertex
  double nonlinear_tets_ = 0, linear_tets_ = 0, interface_ = 0;
};

void add_harmless(Selection& selection, Index zones, double tolerance) {
  while (true) {
    Index best = -1;
    double smallest = tolerance;
    for (Index z = 0; z < zones; ++z) {
      if (selection.linear()[std::size_t(z)]) continue;
      const double error = selection.error_with(z);
      if (error > smallest) continue;
      smallest = error;
      best = z;
    }
    if (best < 0) return;
    selection.flip(best);
  }
}

void make_cheaper(Selection& selection, Index zones, double tolerance) {
  constexpr int passes = 20;
  bool changed = true;
  for (int pass = 0; pass < passes && changed; ++pass) {
    changed = false;
    for (Index z = 0; z < zones; ++z) {
      const double before = selection.cost();
      selection.flip(z);
      const bool better = selection.cost() < before && selection.error() <= tolerance;
      changed = changed || better;
      if (!better) selection.flip(z);
    }
  }
}

}  // namespace

double TrialError::relative(const Zones& zones, const Eigen::VectorXd& error) const {
  return scale * zones.norm(error) / norm;
}

double TrialError::of(const Zones& zones, const std::vector<char>& linear) const {
  Eigen::VectorXd error = Eigen::VectorXd::Zero(contributions.rows());
  for (std::size_t z = 0; z < linear.size(); ++z)
    if (linear[z]) error += contributions.col(Eigen::Index(z));
  return relative(zones, error);
}

std::vector<char> select_zones(const Elements& elements, const Zones& zones,
                               const std::vector<TrialError>& trials, double tolerance, const StepCost& cost,
                               bool condensed) {
  std::vector<char> best(std::size_t(zones.count()), 0);
  double cheapest = std::numeric_limits<double>::max();
  for (const double share :
       {0.25, 0.5, 0.75, 1.0}) {  // of the tolerance: changes that make it cheaper need room
    Selection selection(elements, zones, trials, cost, condensed);
    if (selection.cost() < cheapest) cheapest = selection.cost();
    add_harmless(selection, zones.count(), share * tolerance);
    make_cheaper(selection, zones.count(), tolerance);
    if (selection.cost() >= cheapest) continue;
    cheapest = selection.cost();
    best = selection.linear();
  }
  return best;
}

}  // namespace lobe
