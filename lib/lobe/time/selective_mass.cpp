#include "lobe/time/selective_mass.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/lanczos.h"
#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {
namespace {

constexpr double slightest = 0.07;  // coupling of two vertices that counts, of what they feel alone
// Within so many vertices, those with equal numbers of neighbours are grouped.
constexpr std::size_t window = 128;

// Chebyshev's iteration for A z = x from z = 0 leaves the residual T(ν − a/α)/T(ν) of the part that belongs
// to the eigenvalue a of A, 0 … α (ν + 1) = 1. So z = P(a) x, apart from a factor. T is the Chebyshev
// polynomial of the degree (ν and α are η and ζ in the theory). With T(ν) above 1 no P(a) is zero.
class Chebyshev {
 public:
  explicit Chebyshev(int degree) : degree_(degree), t_(std::acosh(rise) / degree), nu_(std::cosh(t_)) {}

  double first() const { return 1 / (alpha() * nu_); }  // z of the first step is that times x
  double scale() const {                                // of x, for P(0) = 1
    return alpha() * rise * std::sinh(t_) / (degree_ * std::sinh(degree_ * t_));
  }
  // step(back, push): z ← z + back (z − that before) + push (x − A z).
  template <class Step>
  void iterate(Step&& step) const {
    double rho = 1 / nu_;
    for (int k = 1; k < degree_; ++k) {
      const double next = 1 / (2 * nu_ - rho);
      step(next * rho, 2 * next / alpha());
      rho = next;
    }
  }

 private:
  static constexpr double rise = 1.2;  // T(ν)
  double alpha() const { return 1 / (nu_ + 1); }
  int degree_;
  double t_, nu_;
};

}  // namespace

template <class Real>
void SelectiveMass<Real>::follow(const Elements& elements, const std::vector<Index>& vertices,
                                 const std::function<bool(Index)>& takes_part) {
  rows_.resize(std::size_t(elements.topology.vertex_count()));
  for (Index v : vertices) rows_[std::size_t(v)] = find_row(elements, v, takes_part);
}

// The row of L: of the stiffness (λ + 2μ) ∫∇·∇, scaled to what the vertex feels when it moves while its
// neighbours are held.
template <class Real>
auto SelectiveMass<Real>::find_row(const Elements& elements, Index vertex,
                                   const std::function<bool(Index)>& takes_part) const -> Row {
  Row row;
  Mat3<double> K = Mat3<double>::Zero();
  for (Index t : elements.topology.around(vertex)) {
    const Eigen::Vector4i corners = elements.topology.corners(t);
    const Shape s = elements.shape_of(t);
    const Elastic& e = elements.elastic_of(t);
    const bool counts = takes_part(t);
    int corner = 0;
    while (corners[corner] != vertex) ++corner;
    const Vec3d alpha = s.gradients.col(corner);
    K += s.volume * linear_block<double>(linear_law(elements, t), alpha, alpha);
    for (int c = 0; c < 4; ++c) {
      if (c == corner || !counts) continue;
      const double between = -s.volume * (e.lambda + 2 * e.mu) * alpha.dot(s.gradients.col(c));
      const auto is_it = [&](const Neighbour& n) { return n.vertex == corners[c]; };
      auto at = std::find_if(row.neighbours.begin(), row.neighbours.end(), is_it);
      if (at == row.neighbours.end()) at = row.neighbours.insert(at, {corners[c], 0});
      at->weight += between;
    }
  }
  std::erase_if(row.neighbours, [](const Neighbour& n) { return !(n.weight > 0); });
  for (const Neighbour& n : row.neighbours) row.stiffness += n.weight;
  row.ratio = row.stiffness > 0 ? largest_eigenvalue(K) / row.stiffness : 0;
  return row;
}

template <class Real>
double SelectiveMass<Real>::weight(Index vertex, const Neighbour& neighbour) const {
  const Row &a = rows_[std::size_t(vertex)], &b = rows_[std::size_t(neighbour.vertex)];
  return neighbour.weight > slightest * std::sqrt(a.stiffness * b.stiffness)
             ? neighbour.weight * (a.ratio + b.ratio) / 2
             : 0;
}

template <class Real>
void SelectiveMass<Real>::set_moving(const std::vector<MovingVertex<Real>>& moving) {
  struct Couplings {
    MovingVertex<Real> it;
    std::size_t first, end;  // of its couplings
  };
  std::vector<Couplings> of_vertices;
  std::vector<Neighbour> couplings;
  for (const MovingVertex<Real>& it : moving) {
    const std::size_t first = couplings.size();
    for (const Neighbour& neighbour : rows_[std::size_t(it.vertex)].neighbours)
      if (const double w = weight(it.vertex, neighbour); w > 0) couplings.push_back({neighbour.vertex, w});
    of_vertices.push_back({it, first, couplings.size()});
  }
  for (std::size_t at = 0; at < of_vertices.size(); at += window) {
    const auto begin = of_vertices.begin() + std::ptrdiff_t(at);
    const auto end = of_vertices.begin() + std::ptrdiff_t(std::min(at + window, of_vertices.size()));
    std::stable_sort(begin, end, [&](const Couplings& a, const Couplings& b) {
      return a.end - a.first > b.end - b.first;
    });
  }
  order_.clear();
  place_of_.assign(rows_.size(), -1);
  for (std::size_t at = 0; at < of_vertices.size(); ++at) {
    order_.push_back(of_vertices[at].it);
    place_of_[std::size_t(of_vertices[at].it.vertex)] = static_cast<Index>(at);
  }
  const std::size_t places = (of_vertices.size() + 3) / 4 * 4;
  starts_.assign(1, 0);
  fours_.clear();
  diagonal_.assign(places, 0);
  for (std::size_t at = 0; at < places; ++at) {
    const auto row = static_cast<Index>(at - at % 4);
    auto slot = static_cast<std::size_t>(starts_.back());
    for (std::size_t i = at < of_vertices.size() ? of_vertices[at].first : 0;
         at < of_vertices.size() && i < of_vertices[at].end; ++i) {
      const Real coupling = Real(couplings[i].weight * double(of_vertices[at].it.inverse_mass));
      diagonal_[at] += coupling;
      const Index place = place_of_[std::size_t(couplings[i].vertex)];
      if (place < 0) continue;
      if (slot == fours_.size()) fours_.push_back({{row, row, row, row}, {0, 0, 0, 0}});
      fours_[slot].places[at % 4] = place;
      fours_[slot++].weights[at % 4] = coupling;
    }
    if (at % 4 == 3) starts_.push_back(static_cast<Index>(fours_.size()));
  }
  for (Vectors* each : {&right_, &now_, &next_}) *each = Vectors::Zero(4, Eigen::Index(places));
  divide(Real(highest_));
}

template <class Real>
void SelectiveMass<Real>::divide(Real by) {
  for (Real& diagonal : diagonal_) diagonal /= by;
  for (Four& four : fours_)
    for (Real& weight : four.weights) weight /= by;
}

// Calls use(place, own, (A x)_own) for the groups of four [begin, end).
template <class Real>
template <class Use>
void SelectiveMass<Real>::multiply(const Vectors& x, Index begin, Index end, Use&& use) const {
  using Vector = Eigen::Matrix<Real, 4, 1>;
  for (Index g = begin; g < end; ++g) {
    Vector column[4], product[4];
    for (int r = 0; r < 4; ++r) {
      column[r] = x.col(4 * g + r);
      product[r] = diagonal_[std::size_t(4 * g + r)] * column[r];
    }
    for (Index e = starts_[std::size_t(g)]; e < starts_[std::size_t(g) + 1]; ++e) {
      const Four& four = fours_[std::size_t(e)];
      for (int r = 0; r < 4; ++r)
        product[r] -= four.weights[std::size_t(r)] * x.col(four.places[std::size_t(r)]);
    }
    for (int r = 0; r < 4; ++r) use(4 * g + r, column[r], product[r]);
  }
}

template <class Real>
void SelectiveMass<Real>::measure(const std::vector<MovingVertex<Real>>& free) {
  constexpr double margin = 1.02;
  highest_ = 1;
  set_moving(free);
  if (order_.empty()) return;
  std::vector<double> inverse_mass;  // by places
  for (const MovingVertex<Real>& moving : order_) inverse_mass.push_back(double(moving.inverse_mass));
  const HighestFrequency found = highest_frequency<Real>(
      inverse_mass, [&](Index at) { return double(diagonal_[std::size_t(at)]); }, 1,
      [&](const Mat3X<Real>& u, Mat3X<Real>& f) {
        now_.topLeftCorner(3, u.cols()) = u;
        multiply(now_, 0, static_cast<Index>(starts_.size()) - 1,
                 [&](Index at, const auto&, const auto& product) {
                   if (at < u.cols())
                     f.col(at) -= product.template head<3>() / order_[std::size_t(at)].inverse_mass;
                 });
      });
  if (!(found.omega > 0)) return;
  highest_ = margin * found.omega * found.omega;
  divide(Real(highest_));
}

template <class Real>
double SelectiveMass<Real>::dispersion(int degree) const {
  constexpr double small = 1e-5;
  const Chebyshev chebyshev(degree);
  double now = chebyshev.first(), before = 0;
  chebyshev.iterate([&](double back, double push) {
    const double next = now + back * (now - before) + push * (1 - small * now);
    before = std::exchange(now, next);
  });
  return (1 - chebyshev.scale() * now) / (small * highest_);
}

template <class Real>
void SelectiveMass<Real>::apply(const std::vector<HeldVertices::Held>& sliding, Parallel& parallel,
                                Mat3X<Real>& f) {
  const Chebyshev chebyshev(degree_);
  const Real scale = Real(chebyshev.scale()), first = Real(chebyshev.first());
  const auto count = static_cast<Index>(order_.size()), fours = static_cast<Index>(starts_.size()) - 1;
  const auto leave_out = [&](Vectors& z) {
    for (const HeldVertices::Held& item : sliding)
      for (int axis = 0; axis < 3; ++axis)
        if (const Index place = place_of_[std::size_t(item.vertex)]; place >= 0 && item.axes[axis])
          z(axis, place) = 0;
  };
  parallel.for_ranges(count, 4096, [&](Index begin, Index end) {
    for (Index at = begin; at < end; ++at) {
      const auto [v, inverse_mass] = order_[std::size_t(at)];
      right_.col(at).template head<3>() = (scale * inverse_mass) * f.col(v);
      now_.col(at) = first * right_.col(at);
      next_.col(at).setZero();
    }
  });
  leave_out(now_);
  chebyshev.iterate([&](double back, double push) {
    const Real b = Real(back), p = Real(push);
    parallel.for_ranges(fours, 512, [&](Index begin, Index end) {
      multiply(now_, begin, end, [&](Index at, const auto& column, const auto& product) {
        next_.col(at) = column + b * (column - next_.col(at)) + p * (right_.col(at) - product);
      });
    });
    leave_out(next_);
    now_.swap(next_);
  });
  parallel.for_ranges(count, 4096, [&](Index begin, Index end) {
    for (Index at = begin; at < end; ++at) {
      const auto [v, inverse_mass] = order_[std::size_t(at)];
      f.col(v) = now_.col(at).template head<3>() / inverse_mass;
    }
  });
}

template <class Real>
auto SelectiveMass<Real>::acceleration() const -> Acceleration {
  double sum = 0, most_of_it = 0;
  Index vertex = -1;
  for (std::size_t at = 0; at < order_.size(); ++at) {
    const double square = double(now_.col(Eigen::Index(at)).squaredNorm()) / double(order_[at].inverse_mass);
    sum += square;
    if (square <= most_of_it) continue;
    most_of_it = square;
    vertex = order_[at].vertex;
  }
  return {std::sqrt(sum), vertex};
}

template class SelectiveMass<float>;
template class SelectiveMass<double>;

}  // namespace lobe
