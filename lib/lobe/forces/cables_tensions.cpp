// The tensions of a cluster of cables, at given slips.
#include <algorithm>
#include <cmath>

#include "lobe/forces/cables.h"

namespace lobe {

// Of the run's own equation; its spans get their shares of its tension.
void Cables::find_compliance(Run& run) {
  run.compliance = 0;
  const Index own = Index(&run - runs_.data());
  for (Index at = run.begin; at < run.end; ++at) {
    const auto s = std::size_t(order_[std::size_t(at)]);
    run.compliance += compliance_[s] * share_[s];
    for (Index i = coupling_begin_[s]; i < coupling_begin_[s + 1]; ++i) {
      const auto r = std::size_t(couplings_[std::size_t(i)].span);
      if (run_of_[r] == own) run.compliance += inertance_[std::size_t(i)] * share_[r];
    }
    spans_[s].tension = share_[s] * run.tension;
  }
}

// The tensions T of runs are those with A T = b where T > 0 and A T ≥ b where T = 0. Which are taut is found
// by trying, from those of the last step on. All that are on the wrong side change at once; after as many
// tries as there are runs, one at a time.
void Cables::find_tensions(const Cluster& cluster) {
  const std::span<Run> own = runs(cluster);
  for (Run& run : own) find_compliance(run);
  assemble(own);
  constexpr double rounding = 1e-13;
  for (std::size_t attempt = 0; attempt < 2 * own.size() + 50; ++attempt) {
    solve_taut(own);
    double largest = 0;
    for (const Run& run : own) largest = std::max(largest, std::abs(run.tension));
    bool any = false;
    for (std::size_t i = 0; i < own.size() && !(any && attempt >= own.size()); ++i) {
      const bool is_wrong =
          own[i].is_taut ? own[i].tension < 0 : missing(own, i) > rounding * largest * own[i].compliance;
      if (is_wrong) own[i].is_taut = !own[i].is_taut;
      any = any || is_wrong;
    }
    if (!any) break;
  }
  for (Run& run : own) {
    run.tension = std::max(0.0, run.tension);
    for (Index at = run.begin; at < run.end; ++at) {
      const auto s = std::size_t(order_[std::size_t(at)]);
      spans_[s].tension = share_[s] * run.tension;
    }
  }
}

// A as a band, since runs act on those of their own chain and of chains that were sewn beside it.
void Cables::assemble(std::span<Run> own) {
  const auto n = std::size_t(own.size());
  const Index first = Index(own.data() - runs_.data());
  const auto for_couplings = [&](const auto& visit) {  // visit(row, column, span of the row, coupling)
    for (std::size_t i = 0; i < n; ++i)
      for (Index at = own[i].begin; at < own[i].end; ++at) {
        const auto s = std::size_t(order_[std::size_t(at)]);
        for (Index k = coupling_begin_[s]; k < coupling_begin_[s + 1]; ++k)
          visit(i, std::size_t(run_of_[std::size_t(couplings_[std::size_t(k)].span)] - first),
                std::size_t(k));
      }
  };
  band_ = 0;
  for_couplings(
      [&](std::size_t i, std::size_t j, std::size_t) { band_ = std::max(band_, i > j ? i - j : j - i); });
  matrix_.assign(n * (2 * band_ + 1), 0);
  right_.assign(n, 0);
  for_couplings([&](std::size_t i, std::size_t j, std::size_t k) {
    matrix_[place_in_band(i, j)] += inertance_[k] * share_[std::size_t(couplings_[k].span)];
  });
  for (std::size_t i = 0; i < n; ++i) {
    own[i].is_taut = own[i].tension > 0;
    for (Index at = own[i].begin; at < own[i].end; ++at) {
      const auto s = std::size_t(order_[std::size_t(at)]);
      right_[i] += wanted_[s];
      matrix_[place_in_band(i, i)] += compliance_[s] * share_[s];
    }
  }
}

// By how much a run is too short for its tension [m].
double Cables::missing(std::span<const Run> own, std::size_t i) const {
  double sum = right_[i];
  const std::size_t end = std::min(own.size(), i + band_ + 1);
  for (std::size_t j = i - std::min(i, band_); j < end; ++j)
    sum -= matrix_[place_in_band(i, j)] * own[j].tension;
  return sum;
}

// Elimination without pivots: compliances are on the diagonal alone. A run that is slack has the tension 0.
void Cables::solve_taut(std::span<Run> own) {
  const std::size_t n = own.size();
  factor_ = matrix_;
  for (std::size_t i = 0; i < n; ++i) {
    own[i].tension = own[i].is_taut ? right_[i] : 0;
    if (own[i].is_taut) continue;
    const auto row = factor_.begin() + std::ptrdiff_t(i * (2 * band_ + 1));
    std::fill(row, row + std::ptrdiff_t(2 * band_ + 1), 0.0);
    factor_[place_in_band(i, i)] = 1;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t end = std::min(n, k + band_ + 1);
    const double* pivot = &factor_[place_in_band(k, k)];
    for (std::size_t i = k + 1; i < end; ++i) {
      double* row = &factor_[place_in_band(i, k)];
      if (row[0] == 0) continue;
      const double factor = row[0] / pivot[0];
      for (std::size_t j = 1; j < end - k; ++j) row[j] -= factor * pivot[j];
      own[i].tension -= factor * own[k].tension;
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    const std::size_t end = std::min(n, k + band_ + 1);
    const double* row = &factor_[place_in_band(k, k)];
    for (std::size_t j = 1; j < end - k; ++j) own[k].tension -= row[j] * own[k + j].tension;
    own[k].tension /= row[0];
  }
}

}  // namespace lobe
