#include "lobe/forces/cables.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lobe {

void Cables::clear() {
  points_.clear();
  spans_.clear();
  chains_.clear();
  couplings_.clear();
  coupling_begin_.assign(1, 0);
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
  solve_slips();
  constexpr int most_tries = 12;
  for (int i = 0; i < most_tries && give_way(); ++i) solve_slips();
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
void Cables::solve_slips() {
  const int most_tries = 8 + 3 * int(spans_.size());
  constexpr int most_lengths = 20;
  for (int k = 0; k < most_lengths; ++k) {
    for (int i = 0; i < most_tries; ++i) {
      find_runs();
      find_tensions();
      if (!find_slips()) break;
    }
    if (!update_compliances()) break;
  }
  sum_forces();
}

// False if none has changed.
bool Cables::update_compliances() {
  constexpr double tolerance = 1e-13;
  bool any = false;
  for (std::size_t s = 0; s < spans_.size(); ++s) {
    const double now = spans_[s].compliance(spans_[s].length + spans_[s].longer);
    any = any || std::abs(now - compliance_[s]) > tolerance * now;
    compliance_[s] = now;
  }
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

// A closed chain begins behind a point that sticks; without friction, anywhere.
void Cables::find_runs() {
  order_.clear();
  runs_.clear();
  run_of_.resize(spans_.size());
  for (const Chain& chain : chains_) {
    Index first = chain.begin;
    if (chain.is_closed) stick_one(chain);
    if (chain.is_closed)
      for (Index s = chain.begin; s < chain.end; ++s)
        if (spans_[std::size_t(s)].slip == 0) first = next(chain, s);
    Index before = -1;
    for (Index i = chain.begin, s = first; i < chain.end; ++i, s = next(chain, s)) {
      const bool is_joined = before >= 0 && spans_[std::size_t(before)].slip != 0;
      if (!is_joined) {
        const auto at = Index(order_.size());
        runs_.push_back({at, at, spans_[std::size_t(s)].tension, 0});
        share_[std::size_t(s)] = 1;
      } else {
        const double ratio = ratio_[std::size_t(before)];
        share_[std::size_t(s)] =
            share_[std::size_t(before)] * (spans_[std::size_t(before)].slip > 0 ? ratio : 1 / ratio);
      }
      run_of_[std::size_t(s)] = Index(runs_.size()) - 1;
      order_.push_back(s);
      runs_.back().end = Index(order_.size());
      before = s;
    }
  }
}

// By how much a span is too short for its tension [m].
double Cables::residual(Index s) const {
  double sum = wanted_[std::size_t(s)] - compliance_[std::size_t(s)] * spans_[std::size_t(s)].tension;
  for (Index i = coupling_begin_[std::size_t(s)]; i < coupling_begin_[std::size_t(s) + 1]; ++i)
    sum -= inertance_[std::size_t(i)] * spans_[std::size_t(couplings_[std::size_t(i)].span)].tension;
  return sum;
}

// Gauss-Seidel over the runs.
void Cables::find_tensions() {
  for (Run& run : runs_) {
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
  constexpr int most_sweeps = 200;
  constexpr double tolerance = 1e-13;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double change = 0, largest = 0;
    for (Run& run : runs_) {
      double sum = 0;
      for (Index at = run.begin; at < run.end; ++at) sum += residual(order_[std::size_t(at)]);
      const double before = run.tension;
      run.tension = std::max(0.0, before + sum / run.compliance);
      for (Index at = run.begin; at < run.end; ++at) {
        const auto s = std::size_t(order_[std::size_t(at)]);
        spans_[s].tension = share_[s] * run.tension;
      }
      change = std::max(change, std::abs(run.tension - before));
      largest = std::max(largest, run.tension);
    }
    if (change <= tolerance * largest) break;
  }
}

// ---- Slip and stick

// Finds how far each run slips at its points. True if some points are to slip that did not, or the other way
// round.
bool Cables::find_slips() {
  for (const Run& run : runs_) {
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
  for (const Chain& chain : chains_) any = change_slips(chain) || any;
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
  for (const Run& run : runs_) {
    if (run.end == run.begin + 1) continue;
    double sum = 0, missing = 0, spare = 0;
    for (Index at = run.begin; at < run.end; ++at) {
      Span& span = spans_[std::size_t(order_[std::size_t(at)])];
      if (run.tension > 0) {
        const bool is_last = at + 1 == run.end;
        span.length += is_last ? -sum : span.longer;
        sum += span.longer;
        if (is_last) continue;
        const Span& other = spans_[std::size_t(order_[std::size_t(at) + 1])];
        losses.friction += std::abs(sum) * std::abs(span.energy_per_length(other.tension) -
                                                    span.energy_per_length(span.tension));
      } else {
        const double slack = -wanted_[std::size_t(order_[std::size_t(at)])];
        (slack < 0 ? missing : spare) += std::abs(slack);
        if (span.friction > 0) span.slip = 0;
      }
    }
    if (missing == 0 || run.tension > 0) continue;
    for (Index at = run.begin; at < run.end; ++at) {  // what is slack passes into what is taut
      const Index s = order_[std::size_t(at)];
      const double slack = -wanted_[std::size_t(s)];
      spans_[std::size_t(s)].length -= slack < 0 ? slack : slack * missing / spare;
    }
  }
  for (const Point& point : points_) losses.cut += point.force.norm() * point.way;
  return losses;
}

// ---- Tissue that gives way

// Moves points on which more acts than their tissue holds, by Newton's rule. False if there is none.
bool Cables::give_way() {
  constexpr double tolerance = 1e-9;
  bool any = false;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    Point& point = points_[p];
    const double force = point.force.norm(), above = force - point.holds;
    if (!(std::abs(above) > tolerance * point.holds) || (above < 0 && point.way == 0)) continue;
    if (point.way == 0) point.along = point.force / force;
    double slope = 0;  // of the force on the way [N/m]
    for (std::size_t s = 0; s < spans_.size(); ++s) {
      const Span& span = spans_[s];
      if (span.tension == 0 || (span.p != Index(p) && span.q != Index(p))) continue;
      const auto pull = [&](const Span& of) {  // from the point, on it
        double sum = 0;
        if (of.p == Index(p)) sum += of.along.dot(point.along);
        if (of.q == Index(p)) sum -= of.along.dot(point.along);
        return sum;
      };
      const Run& run = runs_[std::size_t(run_of_[s])];
      for (Index at = run.begin; at < run.end; ++at)
        slope += share_[s] * pull(span) * pull(spans_[std::size_t(order_[std::size_t(at)])]) / run.compliance;
    }
    if (!(slope > 0)) continue;
    const double way = std::max(0.0, point.way + above / slope), more = way - point.way;
    if (more == 0) continue;
    point.way = way;
    any = true;
    for (std::size_t s = 0; s < spans_.size(); ++s) {
      if (spans_[s].p == Index(p)) wanted_[s] -= more * spans_[s].along.dot(point.along);
      if (spans_[s].q == Index(p)) wanted_[s] += more * spans_[s].along.dot(point.along);
    }
  }
  return any;
}

}  // namespace lobe
