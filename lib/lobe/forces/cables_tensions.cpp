// The tensions of a cluster of cables, at given slips.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lobe/forces/cables.h"

namespace lobe {
namespace {

constexpr int most = Cables::most_direct;
using Few = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
using FewNumbers = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;

// The solution of A T = b for those that are taut; the others are 0.
FewNumbers solve_taut(const Few& A, const FewNumbers& b, const std::array<bool, most>& is_taut) {
  std::array<int, most> list{};
  int n = 0;
  for (int i = 0; i < int(b.size()); ++i)
    if (is_taut[std::size_t(i)]) list[std::size_t(n++)] = i;
  FewNumbers T = FewNumbers::Zero(b.size());
  if (n == 0) return T;
  Few part(n, n);
  FewNumbers right(n);
  for (int i = 0; i < n; ++i) {
    right[i] = b[list[std::size_t(i)]];
    for (int k = 0; k < n; ++k) part(i, k) = A(list[std::size_t(i)], list[std::size_t(k)]);
  }
  const FewNumbers found = part.partialPivLu().solve(right);
  for (int i = 0; i < n; ++i) T[list[std::size_t(i)]] = found[i];
  return T;
}

// A T = b where T > 0, A T ≥ b where T = 0. Which are taut is found by trying, from those of T on. All that
// are on the wrong side change at once; after as many tries as there are runs, one at a time, which ends.
FewNumbers tensions_of(const Few& A, const FewNumbers& b, FewNumbers T) {
  constexpr double rounding = 1e-13;
  const int n = int(b.size());
  std::array<bool, most> is_taut{};
  for (int i = 0; i < n; ++i) is_taut[std::size_t(i)] = T[i] > 0;
  for (int attempt = 0; attempt < 64; ++attempt) {
    T = solve_taut(A, b, is_taut);
    const double largest = T.cwiseAbs().maxCoeff();
    bool any = false;
    for (int i = 0; i < n && !(any && attempt >= n); ++i) {
      bool& taut = is_taut[std::size_t(i)];
      const bool is_wrong = taut ? T[i] < 0 : b[i] - A.row(i).dot(T) > rounding * largest * A(i, i);
      if (is_wrong) taut = !taut;
      any = any || is_wrong;
    }
    if (!any) break;
  }
  return T.cwiseMax(0);
}

}  // namespace

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

// Gauss-Seidel over blocks of runs: all of a small cluster, or those of one chain. Each is solved at once while
// the tensions of the others are given; so what is alone needs one sweep.
void Cables::find_tensions(const Cluster& cluster) {
  const std::span<Run> own = runs(cluster);
  for (Run& run : own) find_compliance(run);
  constexpr int most_sweeps = 200;
  constexpr double tolerance = 1e-13;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double change = 0, largest = 0;
    std::size_t blocks = 0;
    for (std::size_t begin = 0, end = 0; begin < own.size(); begin = end, ++blocks) {
      end = end_of_block(own, begin);
      change = std::max(change, solve_block(own.subspan(begin, end - begin)));
    }
    for (const Run& run : own) largest = std::max(largest, run.tension);
    if (blocks <= 1 || change <= tolerance * largest) break;
  }
}

std::size_t Cables::end_of_block(std::span<const Run> own, std::size_t begin) const {
  const auto most = std::size_t(most_at_once);
  if (own.size() <= most) return own.size();
  const auto chain = [&](std::size_t i) { return chain_of_[std::size_t(order_[std::size_t(own[i].begin)])]; };
  std::size_t end = begin + 1;
  while (end < own.size() && end - begin < most && chain(end) == chain(begin)) ++end;
  return end;
}

// Returns the largest change of a tension [N].
double Cables::solve_block(std::span<Run> block) {
  const int n = int(block.size());
  if (n == 1) {
    double sum = 0;
    for (Index at = block[0].begin; at < block[0].end; ++at) sum += residual(order_[std::size_t(at)]);
    return set_tension(block[0], std::max(0.0, block[0].tension + sum / block[0].compliance));
  }
  const Index first = Index(block.data() - runs_.data());
  Few A = Few::Zero(n, n);
  FewNumbers b = FewNumbers::Zero(n), before(n);
  for (int i = 0; i < n; ++i) {
    before[i] = block[std::size_t(i)].tension;
    for (Index at = block[std::size_t(i)].begin; at < block[std::size_t(i)].end; ++at) {
      const auto s = std::size_t(order_[std::size_t(at)]);
      b[i] += wanted_[s];
      A(i, i) += compliance_[s] * share_[s];
      for (Index k = coupling_begin_[s]; k < coupling_begin_[s + 1]; ++k) {
        const auto r = std::size_t(couplings_[std::size_t(k)].span);
        const Index of = run_of_[r] - first;
        if (of >= 0 && of < n)
          A(i, of) += inertance_[std::size_t(k)] * share_[r];
        else
          b[i] -= inertance_[std::size_t(k)] * spans_[r].tension;
      }
    }
  }
  const FewNumbers found = tensions_of(A, b, before);
  double change = 0;
  for (int i = 0; i < n; ++i) change = std::max(change, set_tension(block[std::size_t(i)], found[i]));
  return change;
}

double Cables::set_tension(Run& run, double tension) {
  const double change = std::abs(tension - run.tension);
  run.tension = tension;
  for (Index at = run.begin; at < run.end; ++at) {
    const auto s = std::size_t(order_[std::size_t(at)]);
    spans_[s].tension = share_[s] * tension;
  }
  return change;
}

}  // namespace lobe
