#include "lobe/forces/cables.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace lobe {
namespace {

Index root_of(std::vector<Index>& root, Index i) {
  while (root[std::size_t(i)] != i) i = root[std::size_t(i)] = root[std::size_t(root[std::size_t(i)])];
  return i;
}

}  // namespace

void Cables::clear() {
  points_.clear();
  spans_.clear();
  chains_.clear();
  couplings_.clear();
  coupling_begin_.assign(1, 0);
  clusters_.clear();
}

Index Cables::add_point(double holds) {
  points_.emplace_back().holds = holds;
  return Index(points_.size()) - 1;
}

void Cables::add_chain(const std::vector<Span>& spans, bool is_closed) {
  const auto begin = Index(spans_.size());
  spans_.insert(spans_.end(), spans.begin(), spans.end());
  chains_.push_back({begin, Index(spans_.size()), is_closed});
  coupling_begin_.resize(spans_.size() + 1, coupling_begin_.back());
  clusters_.clear();
}

// ---- Clusters

void Cables::find_clusters() {
  root_.resize(chains_.size());
  std::iota(root_.begin(), root_.end(), Index(0));
  const auto join = [&](Index a, Index b) {  // the first chain is the root
    a = root_of(root_, a);
    b = root_of(root_, b);
    root_[std::size_t(std::max(a, b))] = std::min(a, b);
  };
  chain_of_.resize(spans_.size());
  chain_at_.assign(points_.size(), -1);
  for (Index c = 0; c < Index(chains_.size()); ++c)
    for (Index s = chains_[std::size_t(c)].begin; s < chains_[std::size_t(c)].end; ++s) {
      chain_of_[std::size_t(s)] = c;
      for (const Index p : {spans_[std::size_t(s)].p, spans_[std::size_t(s)].q}) {
        Index& at = chain_at_[std::size_t(p)];
        if (at < 0) at = c;
        join(at, c);
      }
    }
  for (std::size_t s = 0; s < spans_.size(); ++s)
    for (Index i = coupling_begin_[s]; i < coupling_begin_[s + 1]; ++i)
      join(chain_of_[s], chain_of_[std::size_t(couplings_[std::size_t(i)].span)]);
  for (Index c = 0; c < Index(root_.size()); ++c) root_[std::size_t(c)] = root_of(root_, c);
  list_clusters();
}

void Cables::list_clusters() {
  const auto root_at = [&](Index p) { return root_[std::size_t(chain_at_[std::size_t(p)])]; };
  chains_of_.resize(chains_.size());
  std::iota(chains_of_.begin(), chains_of_.end(), Index(0));
  std::sort(chains_of_.begin(), chains_of_.end(), [&](Index a, Index b) {
    return std::pair(root_[std::size_t(a)], a) < std::pair(root_[std::size_t(b)], b);
  });
  points_of_.clear();
  for (Index p = 0; p < Index(points_.size()); ++p)
    if (chain_at_[std::size_t(p)] >= 0) points_of_.push_back(p);
  std::sort(points_of_.begin(), points_of_.end(),
            [&](Index a, Index b) { return std::pair(root_at(a), a) < std::pair(root_at(b), b); });
  clusters_.clear();
  Index span = 0, p = 0;
  for (std::size_t i = 0; i < chains_of_.size();) {
    const Index root = root_[std::size_t(chains_of_[i])];
    Cluster cluster{Index(i), Index(i), p, p, span, 0, span};
    for (; i < chains_of_.size() && root_[std::size_t(chains_of_[i])] == root; ++i) {
      const Chain& chain = chains_[std::size_t(chains_of_[i])];
      span += chain.end - chain.begin;
    }
    while (p < Index(points_of_.size()) && root_at(points_of_[std::size_t(p)]) == root) ++p;
    cluster.chains_end = Index(i);
    cluster.points_end = p;
    cluster.spans = span - cluster.begin;
    clusters_.push_back(cluster);
  }
  order_.resize(spans_.size());
  run_of_.resize(spans_.size());
  runs_.resize(spans_.size());  // a cluster has no more runs than spans
}

void Cables::place() {
  for (Span& span : spans_) {
    const Vec3d way = points_[std::size_t(span.q)].x - points_[std::size_t(span.p)].x;
    span.stretched = way.norm();
    span.along = span.stretched > 0 ? Vec3d(way / span.stretched) : Vec3d::Zero();
  }
}

void Cables::sum_forces() {
  for (Point& point : points_) point.force.setZero();
  for (const Span& span : spans_) {
    points_[std::size_t(span.p)].force += span.tension * span.along;
    points_[std::size_t(span.q)].force -= span.tension * span.along;
  }
}

double Cables::energy() const {
  double sum = 0;
  for (const Span& span : spans_) {
    const double longer = std::max(0.0, span.stretched - span.length);
    sum += longer * longer / (2 * span.compliance(span.length));
  }
  return sum;
}

// ---- The equations

void Cables::solve(double dt, double push) {
  if (clusters_.empty()) find_clusters();
  place();
  const std::size_t count = spans_.size();
  for (auto* per_span : {&wanted_, &ratio_, &share_, &through_, &compliance_}) per_span->assign(count, 0);
  inertance_.resize(couplings_.size());
  for (std::size_t s = 0; s < count; ++s) {
    Span& span = spans_[s];
    compliance_[s] = span.compliance(span.length);
    const Point &p = points_[std::size_t(span.p)], &q = points_[std::size_t(span.q)];
    wanted_[s] = span.stretched + dt * span.along.dot(q.v - p.v) - span.length;
    span.longer = 0;
    for (Index i = coupling_begin_[s]; i < coupling_begin_[s + 1]; ++i) {
      const Coupling& coupling = couplings_[std::size_t(i)];
      inertance_[std::size_t(i)] =
          dt * push *
          span.along.cwiseProduct(coupling.mobility).dot(spans_[std::size_t(coupling.span)].along);
    }
  }
  for (Point& point : points_) {
    point.way = 0;
    point.along.setZero();
  }
  find_friction();
  constexpr int most_tries = 12;
  for (Cluster& cluster : clusters_) {
    solve_slips(cluster);
    for (int i = 0; i < most_tries && give_way(cluster); ++i) solve_slips(cluster);
  }
}

// e^(μθ) where each span passes into the next.
void Cables::find_friction() {
  for (const Chain& chain : chains_)
    for (Index s = chain.begin; s < chain.end; ++s) {
      const Index to = next(chain, s);
      if (to < 0) continue;
      const Span &span = spans_[std::size_t(s)], &other = spans_[std::size_t(to)];
      const double angle =
          span.friction == 0 ? 0
                             : std::atan2(span.along.cross(other.along).norm(), span.along.dot(other.along));
      ratio_[std::size_t(s)] = std::exp(span.friction * angle);
      if (span.friction == 0) spans_[std::size_t(s)].slip = 1;
    }
}

// What slips into a span makes it softer. So the compliances are those of the lengths that the spans get.
void Cables::solve_slips(Cluster& cluster) {
  const int most_tries = 8 + 3 * int(cluster.spans);
  constexpr int most_lengths = 20;
  for (int k = 0; k < most_lengths; ++k) {
    for (int i = 0; i < most_tries; ++i) {
      find_runs(cluster);
      find_tensions(cluster);
      if (!find_slips(cluster)) break;
    }
    if (!update_compliances(cluster)) break;
  }
  sum_forces(cluster);
}

void Cables::sum_forces(const Cluster& cluster) {
  for (Index i = cluster.points_begin; i < cluster.points_end; ++i)
    points_[std::size_t(points_of_[std::size_t(i)])].force.setZero();
  for_spans(cluster, [&](std::size_t s) {
    const Span& span = spans_[s];
    points_[std::size_t(span.p)].force += span.tension * span.along;
    points_[std::size_t(span.q)].force -= span.tension * span.along;
  });
}

// False if none has changed.
bool Cables::update_compliances(const Cluster& cluster) {
  constexpr double tolerance = 1e-13;
  bool any = false;
  for_spans(cluster, [&](std::size_t s) {
    const double now = spans_[s].compliance(spans_[s].length + spans_[s].longer);
    any = any || std::abs(now - compliance_[s]) > tolerance * now;
    compliance_[s] = now;
  });
  return any;
}

// If all points of a closed chain slip, the tensions on both sides of one of them are not free. It is the
// point past which least slips against the way in which the last that stuck has begun to slip.
void Cables::stick_one(const Chain& chain) {
  Index last_stuck = chain.end - 1;
  for (Index s = chain.begin; s < chain.end; ++s) {
    if (spans_[std::size_t(s)].slip == 0 || spans_[std::size_t(s)].friction == 0) return;
    if (through_[std::size_t(s)] == 0) last_stuck = s;
  }
  Index found = last_stuck;
  double least = std::numeric_limits<double>::infinity();
  for (Index s = chain.begin; s < chain.end; ++s) {
    if (spans_[std::size_t(s)].slip == spans_[std::size_t(last_stuck)].slip) continue;
    if (!(std::abs(through_[std::size_t(s)]) < least)) continue;
    least = std::abs(through_[std::size_t(s)]);
    found = s;
  }
  spans_[std::size_t(found)].slip = 0;
}

void Cables::find_runs(Cluster& cluster) {
  cluster.runs_end = cluster.begin;
  Index at = cluster.begin;  // in order_
  for (Index i = cluster.chains_begin; i < cluster.chains_end; ++i)
    find_runs_of(chains_[std::size_t(chains_of_[std::size_t(i)])], cluster, at);
}

// A closed chain begins behind a point that sticks; without friction, anywhere.
void Cables::find_runs_of(const Chain& chain, Cluster& cluster, Index& at) {
  Index first = chain.begin;
  if (chain.is_closed) stick_one(chain);
  if (chain.is_closed)
    for (Index s = chain.begin; s < chain.end; ++s)
      if (spans_[std::size_t(s)].slip == 0) first = next(chain, s);
  Index before = -1;
  for (Index i = chain.begin, s = first; i < chain.end; ++i, s = next(chain, s)) {
    const bool is_joined = before >= 0 && spans_[std::size_t(before)].slip != 0;
    if (!is_joined) {
      runs_[std::size_t(cluster.runs_end++)] = {at, at, spans_[std::size_t(s)].tension, 0};
      share_[std::size_t(s)] = 1;
    } else {
      const double ratio = ratio_[std::size_t(before)];
      share_[std::size_t(s)] =
          share_[std::size_t(before)] * (spans_[std::size_t(before)].slip > 0 ? ratio : 1 / ratio);
    }
    run_of_[std::size_t(s)] = cluster.runs_end - 1;
    order_[std::size_t(at)] = s;
    runs_[std::size_t(cluster.runs_end - 1)].end = ++at;
    before = s;
  }
}

// By how much a span is too short for its tension [m].
double Cables::residual(Index s) const {
  double sum = wanted_[std::size_t(s)] - compliance_[std::size_t(s)] * spans_[std::size_t(s)].tension;
  for (Index i = coupling_begin_[std::size_t(s)]; i < coupling_begin_[std::size_t(s) + 1]; ++i)
    sum -= inertance_[std::size_t(i)] * spans_[std::size_t(couplings_[std::size_t(i)].span)].tension;
  return sum;
}

}  // namespace lobe
