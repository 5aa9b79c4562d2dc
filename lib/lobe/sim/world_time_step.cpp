// The time step of a World (theory, section 7).
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "lobe/sim/world.h"

namespace lobe {

template <class Real>
void World<Real>::find_frequencies() {
  find_frequencies([&](Index v) { return weight_of(v); });
  known_ = Known::anew;
}

template <class Real>
template <class Weight>
void World<Real>::find_frequencies(Weight&& weight) {
  frequencies_.find(elements_.topology.vertex_count(), weight, [&](DiagonalStiffness& K) {
    tensor_mass_.add_diagonal_stiffness(K);
    auto found = nonlinear_.add_diagonal_stiffness(state_.u.padded(), K, parallel_);
    if (is_expanded_) {
      const auto others = expanded_.add_diagonal_stiffness(state_.u.padded(), K, parallel_);
      if (others.smallest_volume_ratio < found.smallest_volume_ratio) found = others;
    } else {
      precomputed_.add_diagonal_stiffness(state_.u.padded(), K);
    }
    volume_ratio_ = found.smallest_volume_ratio;
    volume_ratio_tet_ = found.smallest_tet;
  });
  kept_is_stale_ = true;  // stiffness has taken the place of forces
}

template <class Real>
VertexFrequency World<Real>::highest_vertex() {
  const auto alone = [&](Index v) { return inverse_mass_[std::size_t(v)]; };
  find_frequencies(alone);
  known_ = Known::stale;
  return frequencies_.highest(alone);
}

// About the present state, by displacements that are small enough for forces to be linear, and large enough for their
// differences to be known. Nothing is found where the body has gone so far that there are none.
template <class Real>
HighestFrequency World<Real>::search_highest(const LanczosSettings& settings) {
  const Mat3X<Real> at = state_.u.view();
  double farthest = 0;  // of what moves by itself [m]
  for (Index v = 0; v < state_.u.count(); ++v)
    if (inverse_mass_[v] > 0) farthest = std::max(farthest, double(at.col(v).norm()));
  const bool at_rest = farthest == 0;
  const double small =
      at_rest ? 1e-9 * longest_move_ : std::sqrt(double(std::numeric_limits<Real>::epsilon())) / 3 * farthest;
  if (!(small < 0.01 * longest_move_)) return {};
  forget_kept_forces();
  kept_is_stale_ = true;
  const auto add_forces = [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
    add_internal_forces(u, f);
    if (is_expanded_) return;
    if (at_rest)
      precomputed_.add_stiffness_forces(u, f, parallel_);
    else
      precomputed_.add_forces(u, Real(missing_loads(state_.time)), f, parallel_);
  };
  Mat3X<Real> there = Mat3X<Real>::Zero(3, at.cols());
  if (!at_rest) add_forces(at, there);
  const std::function<void(Mat3X<Real>&)> nothing, scale = [&](Mat3X<Real>&f) {
    find_inertia();
    selective_mass_.apply(led_, parallel_, f);
  };
  return highest_frequency<Real>(
      inverse_mass_, [&](Index v) { return bounded_square(v); }, small,
      [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
        f -= there;
        add_forces(at_rest ? u : Mat3X<Real>(at + u), f);
      },
      settings, selective_mass_.degree() > 1 ? scale : nothing);
}

template <class Real>
void World<Real>::measure_at_rest() {
  ratios_.forget_all(1);
  const double vertex = highest_vertex().omega;
  if (!(vertex > 0)) return;
  frequency_search_ = search_highest({});
  at_rest().ratio = std::max(least_ratio(), frequency_search_.omega / vertex);
  at_rest().omega = at_rest().ratio * vertex;
  ratios_.forget_all(at_rest().ratio);
  ratios_.limit = time_step_limit();
}

template <class Real>
void World<Real>::measure_degrees_at_rest() {
  for (int degree : mass_degrees()) {
    selective_mass_.set_degree(degree);
    measure_at_rest();
  }
}

// At a frame's start, where the limit has changed.
template <class Real>
void World<Real>::measure_again() {
  if (implicit_) return;
  if (selective_mass_.degree() > 1 && sleep_.any()) return;  // C knows of those who move only
  const double limit = time_step_limit();
  if (!ratios_.is_worth_measuring(limit)) return;
  ratios_.steps = 0;
  ratios_.limit = limit;
  const HighestFrequency found = search_highest({.tolerance = 0.02, .most = FrequencyRatios::evaluations});
  if (!(found.omega > 0)) return;
  std::vector<double> alone;
  for (Index v = 0; v < elements_.topology.vertex_count(); ++v)
    alone.push_back(std::sqrt(frequencies_.exact_square(v, inverse_mass_[std::size_t(v)])));
  ratios_.measured(found.omega, alone, least_ratio());
  frequencies_.weigh([&](Index v) { return weight_of(v); });
  ratios_.limit = time_step_limit();
}

template <class Real>
void World<Real>::scale_masses() {
  mass_scaling_.limit_before = time_step_limit();
  std::vector<Index> all(mass_.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> squares;
  for (Index v : all) squares.push_back(frequencies_.exact_square(v, inverse_mass_[v]));
  const double total = std::accumulate(mass_.begin(), mass_.end(), 0.0);
  mass_factor_ = mass_factors(mass_, squares, setup_.mass_scaling * total);
  refresh_vertices(all);
  mass_scaling_.added = std::accumulate(mass_.begin(), mass_.end(), 0.0) - total;
  mass_scaling_.share = mass_scaling_.added / total;
  measure_degrees_at_rest();
  mass_scaling_.limit_after = time_step_limit();
}

template <class Real>
double World<Real>::time_step_limit() {
  // SVK softens when crushed; a step far beyond that of the body at rest would still be rash.
  if (known_ == Known::stale) find_frequencies();
  const VertexFrequency highest = frequencies_.highest([&](Index v) { return weight_of(v); });
  limiting_vertex_ = highest.vertex;
  const double omega = std::max(highest.omega, at_rest().omega / 4);
  return omega > 0 ? 2 / omega : std::numeric_limits<double>::infinity();
}

template class World<float>;
template class World<double>;

}  // namespace lobe
