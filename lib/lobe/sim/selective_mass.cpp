#include "lobe/sim/selective_mass.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe/fem/hooke.h"
#include "lobe/sim/frequency.h"

namespace lobe {
namespace {

double largest_eigenvalue(const Mat3<double>& K) {
  Eigen::SelfAdjointEigenSolver<Mat3<double>> solver;
  solver.computeDirect(K, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[2];
}

}  // namespace

template <class Real>
void SelectiveMass<Real>::rebuild(const Elements& elements, const std::vector<double>& inverse_mass,
                                  const std::function<bool(Index)>& takes_part) {
  find_weights(elements, inverse_mass, takes_part);
  normalise(inverse_mass);
}

template <class Real>
void SelectiveMass<Real>::find_weights(const Elements& elements, const std::vector<double>& inverse_mass,
                                       const std::function<bool(Index)>& takes_part) {
  constexpr double slightest = 0.05;
  const Index n = elements.topology.vertex_count();
  std::vector<Mat3<double>> K(std::size_t(n), Mat3<double>::Zero());
  std::vector<double> own(std::size_t(n), 0), ratio(std::size_t(n), 0);
  struct Six { double w[4][4]; };
  std::vector<Six> edges(std::size_t(elements.topology.tet_count()));
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Shape s = elements.shape_of(t);
    const Elastic& e = elements.elastic_of(t);
    const bool m = takes_part(t);
    for (int c = 0; c < 4; ++c) {
      const Index v = elements.topology.tets()(c, t);
      const Vec3d a = s.gradients.col(c);
      K[v] += s.volume * hooke_block<double>(a, a, e.lambda, e.mu);
      for (int d = 0; d < 4; ++d)
        edges[t].w[c][d] = m ? s.volume * (e.lambda + 2 * e.mu) * a.dot(s.gradients.col(d)) : 0;
      own[v] += edges[t].w[c][c];
    }
  }
  starts_.assign(1, 0);
  neighbours_.clear();
  std::vector<Index> place(std::size_t(n), -1);
  std::vector<std::pair<Index, double>> found;
  std::vector<double> weights;
  for (Index v = 0; v < n; ++v) {
    found.clear();
    for (Index t : elements.topology.around(v)) {
      const Eigen::Vector4i corners = elements.topology.corners(t);
      const int c = corners[0] == v ? 0 : corners[1] == v ? 1 : corners[2] == v ? 2 : 3;
      for (int d = 0; d < 4; ++d) {
        if (d == c) continue;
        Index& at = place[corners[d]];
        if (at < 0) {
          at = static_cast<Index>(found.size());
          found.push_back({corners[d], 0});
        }
        found[at].second -= edges[t].w[c][d];
      }
    }
    double sum = 0;
    for (const auto& [other, weight] : found) {
      place[other] = -1;
      if (weight <= slightest * std::sqrt(own[v] * own[other])) continue;
      neighbours_.push_back({other, 0});
      weights.push_back(weight);
      sum += weight;
    }
    ratio[v] = sum > 0 ? largest_eigenvalue(K[v]) / sum : 0;
    starts_.push_back(static_cast<Index>(neighbours_.size()));
  }
  diagonal_.assign(std::size_t(n), 0);
  for (Index v = 0; v < n; ++v) {
    double sum = 0;
    for (Index at = starts_[v]; at < starts_[v + 1]; ++at) {
      const double w = weights[at] * (ratio[v] + ratio[neighbours_[at].vertex]) / 2 * inverse_mass[v];
      neighbours_[at].weight = Real(w);
      sum += w;
    }
    diagonal_[v] = Real(sum);
  }
}

template <class Real>
void SelectiveMass<Real>::normalise(const std::vector<double>& inverse_mass) {
  const auto n = static_cast<Index>(inverse_mass.size());
  const HighestFrequency highest = highest_frequency<Real>(
      inverse_mass, [&](Index v) { return double(diagonal_[v]); }, 1,
      [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
        for (Index v = 0; v < n; ++v) {
          if (inverse_mass[v] == 0) continue;
          Vec3<Real> sum = -diagonal_[v] * u.col(v);
          for (Index at = starts_[v]; at < starts_[v + 1]; ++at)
            sum += neighbours_[at].weight * u.col(neighbours_[at].vertex);
          f.col(v) += sum / Real(inverse_mass[v]);
        }
      });
  highest_ = 1.02 * highest.omega * highest.omega;
  const double scale = 1 / highest_;
  if (!(highest.omega > 0)) return;
  for (Neighbour& own : neighbours_) own.weight *= Real(scale);
  for (Real& own : diagonal_) own *= Real(scale);
}

template <class Real>
void SelectiveMass<Real>::arrange(const std::vector<MovingVertex<Real>>& moving) {
  order_ = moving;
  const auto count = [&](const MovingVertex<Real>& own) { return starts_[own.vertex + 1] - starts_[own.vertex]; };
  constexpr std::size_t window = 128;
  for (std::size_t at = 0; at < order_.size(); at += window) {
    const auto begin = order_.begin() + std::ptrdiff_t(at);
    const auto end = order_.begin() + std::ptrdiff_t(std::min(at + window, order_.size()));
    std::stable_sort(begin, end, [&](const auto& a, const auto& b) { return count(a) > count(b); });
  }
  const std::size_t fours = (order_.size() + 3) / 4;
  place_of_.assign(diagonal_.size(), -1);
  for (std::size_t at = 0; at < order_.size(); ++at) place_of_[order_[at].vertex] = static_cast<Index>(at);
  four_starts_.assign(1, 0);
  fours_.clear();
  own_.assign(4 * fours, 0);
  for (std::size_t at = 0; at < 4 * fours; at += 4) {
    const std::size_t begin = fours_.size();
    for (std::size_t r = 0; r < 4 && at + r < order_.size(); ++r) {
      const Index v = order_[at + r].vertex;
      own_[at + r] = diagonal_[v];
      std::size_t slot = begin;
      for (Index e = starts_[v]; e < starts_[v + 1]; ++e) {
        const Index place = place_of_[neighbours_[e].vertex];
        if (place < 0) continue;
        if (slot == fours_.size()) fours_.push_back({{Index(at), Index(at), Index(at), Index(at)}, {0, 0, 0, 0}});
        fours_[slot].places[r] = place;
        fours_[slot].weights[r] = neighbours_[e].weight;
        ++slot;
      }
    }
    four_starts_.push_back(static_cast<Index>(fours_.size()));
  }
  for (Vectors* each : {&right_, &now_, &next_}) *each = Vectors::Zero(4, Eigen::Index(4 * fours));
}

namespace {

// Chebyshev's iteration for A z = x from z = 0 leaves the residual T(ν − a/α)/T(ν), so that z = P(a) x up to a factor; the
// eigenvalues a of A lie in 0 … α (ν + 1) = 1. With T(ν) above 1 no P(a) is zero.
struct Chebyshev {
  static constexpr double rise = 1.2;  // T(ν)
  explicit Chebyshev(int degree)
      : t(std::acosh(rise) / degree), nu(std::cosh(t)), alpha(1 / (nu + 1)),
        sum(degree * std::sinh(degree * t) / std::sinh(t) / (alpha * rise)) {}
  double t, nu, alpha;
  double sum;  // of z where a = 0
};

}  // namespace

template <class Real>
double SelectiveMass<Real>::lag(int degree) const {
  if (degree == 1) return 0;
  const Chebyshev c(degree);
  const auto P = [&](double a) {
    double rho = 1 / c.nu, now = 1 / (c.alpha * c.nu), before = 0;
    for (int k = 1; k < degree; ++k) {
      const double next = 1 / (2 * c.nu - rho);
      const double z = now + next * rho * (now - before) + 2 * next / c.alpha * (1 - a * now);
      before = std::exchange(now, z);
      rho = next;
    }
    return now / c.sum;
  };
  constexpr double small = 1e-5;
  return (1 - P(small)) / small / highest_;
}

template <class Real>
std::array<double, 3> SelectiveMass<Real>::defect() const {
  const Chebyshev c(degree_);
  double square = 0, stiff = 0, all = 0;
  const Vectors d = now_ - right_ * Real(c.sum);
  for (std::size_t at = 0; at < order_.size(); ++at) {
    const double m = 1 / double(order_[at].inverse_mass);
    Eigen::Matrix<Real, 4, 1> own = own_[at] * d.col(at);
    const std::size_t g = at / 4, r = at % 4;
    for (Index e = four_starts_[g]; e < four_starts_[g + 1]; ++e) own -= fours_[e].weights[r] * d.col(fours_[e].places[r]);
    square += m * d.col(at).squaredNorm();
    stiff += m * d.col(at).dot(own);
    all += m * now_.col(at).squaredNorm();
  }
  return {std::sqrt(square), square > 0 ? stiff / square * highest_ : 1, std::sqrt(all)};
}

template <class Real>
void SelectiveMass<Real>::apply(const std::vector<HeldVertices::Held>& sliding, Parallel& parallel,
                                Mat3X<Real>& f) {
  using Vector = Eigen::Matrix<Real, 4, 1>;
  const Chebyshev c(degree_);
  const auto count = static_cast<Index>(order_.size()), fours = static_cast<Index>(four_starts_.size()) - 1;
  const Real scale = Real(1 / c.sum), first = Real(1 / (c.alpha * c.nu));
  const auto leave_out = [&](Vectors& z) {
    for (const HeldVertices::Held& item : sliding)
      if (const Index place = place_of_[item.vertex]; place >= 0)
        for (int d = 0; d < 3; ++d)
          if (item.axes[d]) z(d, place) = 0;
  };
  parallel.for_ranges(count, 4096, [&](Index begin, Index end) {
    for (Index at = begin; at < end; ++at) {
      const auto [v, inverse_mass] = order_[at];
      right_.col(at).template head<3>() = (scale * inverse_mass) * f.col(v);
      now_.col(at) = first * right_.col(at);
      next_.col(at).setZero();
    }
  });
  leave_out(now_);
  double rho = 1 / c.nu;
  for (int k = 1; k < degree_; ++k) {
    const double rho_next = 1 / (2 * c.nu - rho);
    const Real back = Real(rho_next * rho), push = Real(2 * rho_next / c.alpha);
    rho = rho_next;
    parallel.for_ranges(fours, 512, [&](Index begin, Index end) {
      for (Index g = begin; g < end; ++g) {
        const Index at = 4 * g;
        Vector rest[4];
        for (int r = 0; r < 4; ++r) rest[r] = right_.col(at + r) - own_[at + r] * now_.col(at + r);
        for (Index e = four_starts_[g]; e < four_starts_[g + 1]; ++e)
          for (int r = 0; r < 4; ++r) rest[r] += fours_[e].weights[r] * now_.col(fours_[e].places[r]);
        for (int r = 0; r < 4; ++r) {
          const Vector own = now_.col(at + r), before = next_.col(at + r);
          next_.col(at + r) = own + back * (own - before) + push * rest[r];
        }
      }
    });
    leave_out(next_);
    now_.swap(next_);
  }
  parallel.for_ranges(count, 4096, [&](Index begin, Index end) {
    for (Index at = begin; at < end; ++at)
      f.col(order_[at].vertex) = now_.col(at).template head<3>() / order_[at].inverse_mass;
  });
}

template class SelectiveMass<float>;
template class SelectiveMass<double>;

}  // namespace lobe
