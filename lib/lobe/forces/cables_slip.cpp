// Where cables slip and stick, and tissue that gives way.
#include <algorithm>
#include <cmath>

#include "lobe/forces/cables.h"

namespace lobe {

// ---- Slip and stick

// Finds how far each run slips at its points. True if some points are to slip that did not, or the other way
// round.
bool Cables::find_slips(const Cluster& cluster) {
  for (const Run& run : runs(cluster)) {
    double sum = 0;
    for (Index at = run.begin; at < run.end; ++at) {
      const Index s = order_[std::size_t(at)];
      const double longer = run.tension > 0 ? residual(s) : 0;
      spans_[std::size_t(s)].longer = longer;
      sum -= longer;
      through_[std::size_t(s)] = at + 1 < run.end ? sum : 0;
    }
  }
  bool any = false;
  for (Index i = cluster.chains_begin; i < cluster.chains_end; ++i)
    any = change_slips(chains_[std::size_t(chains_of_[std::size_t(i)])]) || any;
  return any;
}

bool Cables::change_slips(const Chain& chain) {
  constexpr double rounding = 1e-12;
  bool any = false;
  for (Index s = chain.begin; s < chain.end; ++s) {
    const Index to = next(chain, s);
    Span& span = spans_[std::size_t(s)];
    if (to < 0 || span.friction == 0) continue;
    const double ratio = ratio_[std::size_t(s)], before = span.tension,
                 behind = spans_[std::size_t(to)].tension;
    if (span.slip != 0) {
      const bool is_back = span.slip * through_[std::size_t(s)] < -rounding * span.stretched;
      if (before > 0 && is_back) {
        span.slip = 0;
        any = true;
      }
    } else if (behind > before * ratio * (1 + rounding)) {
      span.slip = 1;
      any = true;
    } else if (before > behind * ratio * (1 + rounding)) {
      span.slip = -1;
      any = true;
    }
  }
  return any;
}

Cables::Losses Cables::slip() {
  Losses losses;
  for (const Cluster& cluster : clusters_)
    for (const Run& run : runs(cluster))
      if (run.end > run.begin + 1) slip_run(run, losses);
  for (const Point& point : points_) losses.cut += point.force.norm() * point.way;
  return losses;
}

void Cables::slip_run(const Run& run, Losses& losses) {
  double sum = 0, missing = 0, spare = 0;
  for (Index at = run.begin; at < run.end; ++at) {
    const Index s = order_[std::size_t(at)];
    Span& span = spans_[std::size_t(s)];
    if (run.tension > 0) {
      const bool is_last = at + 1 == run.end;
      span.length += is_last ? -sum : span.longer;
      sum += span.longer;
      if (is_last) continue;
      const Span& other = spans_[std::size_t(order_[std::size_t(at) + 1])];
      losses.friction += std::abs(sum) * std::abs(span.energy_per_length(other.tension) -
                                                  span.energy_per_length(span.tension));
    } else {
      const double slack = -residual(s);
      (slack < 0 ? missing : spare) += std::abs(slack);
      if (span.friction > 0) span.slip = 0;
    }
  }
  if (missing == 0 || !(spare >= missing) || run.tension > 0) return;
  for (Index at = run.begin; at < run.end; ++at) {  // what is slack passes into what is taut
    const Index s = order_[std::size_t(at)];
    const double slack = -residual(s);
    spans_[std::size_t(s)].length -= slack < 0 ? slack : slack * missing / spare;
  }
}

// ---- Tissue that gives way

// Of the force on a point along its way, per length of that [N/m].
double Cables::give_way_slope(const Cluster& cluster, Index p) const {
  const Point& point = points_[std::size_t(p)];
  const auto pull = [&](const Span& of) {  // from the point, on it
    double sum = 0;
    if (of.p == p) sum += of.along.dot(point.along);
    if (of.q == p) sum -= of.along.dot(point.along);
    return sum;
  };
  double slope = 0;
  for_spans(cluster, [&](std::size_t s) {
    const Span& span = spans_[s];
    if (span.tension == 0 || (span.p != p && span.q != p)) return;
    const Run& run = runs_[std::size_t(run_of_[s])];
    for (Index at = run.begin; at < run.end; ++at)
      slope += share_[s] * pull(span) * pull(spans_[std::size_t(order_[std::size_t(at)])]) / run.compliance;
  });
  return slope;
}

// Moves points on which more acts than their tissue holds, by Newton's rule. False if there is none.
bool Cables::give_way(const Cluster& cluster) {
  constexpr double tolerance = 1e-9;
  bool any = false;
  for (Index i = cluster.points_begin; i < cluster.points_end; ++i) {
    const Index p = points_of_[std::size_t(i)];
    Point& point = points_[std::size_t(p)];
    const double force = point.force.norm(), above = force - point.holds;
    if (!(std::abs(above) > tolerance * point.holds) || (above < 0 && point.way == 0)) continue;
    if (point.way == 0) point.along = point.force / force;
    const double slope = give_way_slope(cluster, p);
    if (!(slope > 0)) continue;
    const double way = std::max(0.0, point.way + above / slope), more = way - point.way;
    if (more == 0) continue;
    point.way = way;
    any = true;
    for_spans(cluster, [&](std::size_t s) {
      if (spans_[s].p == p) wanted_[s] -= more * spans_[s].along.dot(point.along);
      if (spans_[s].q == p) wanted_[s] += more * spans_[s].along.dot(point.along);
    });
  }
  return any;
}

}  // namespace lobe
