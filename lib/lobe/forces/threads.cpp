#include "lobe/forces/threads.h"

#include <algorithm>
#include <cmath>

#include "lobe/error.h"
#include "lobe/forces/inverse_mass.h"
#include "lobe/text.h"

namespace lobe {

template <class Real>
Threads<Real>::Threads(const Setup& setup) {
  for (const StitchSetup& stitch : setup.stitches)
    state_.threads.push_back(planned(stitch, int(state_.threads.size())));
}

// ---- The cables

template <class Real>
void Threads<Real>::see_body(const BodyView& body, const At&) {
  grains_ = body.grains;
  const Revisions& now = body.model.revisions;
  if (seen_structure_ == now.structure && seen_inertia_ == now.inertia &&
      inverse_mass_.cols() == Eigen::Index(body.mass.size()))
    return;
  seen_structure_ = now.structure;
  seen_inertia_ = now.inertia;
  set_inverse_mass(body, inverse_mass_);
  is_coupled_ = false;
}

template <class Real>
void Threads<Real>::arrange() {
  if (is_arranged_) return;
  cables_.clear();
  sources_.clear();
  span_sources_.clear();
  for (std::size_t i = 0; i < state_.threads.size(); ++i)
    if (state_.threads[i].may_be_taut()) add_cables_of(i);
  is_arranged_ = true;
  is_coupled_ = false;
}

// Each loop is a closed chain; the thread between two knots, or from a knot to the hand, is an open one. What
// ends freely pulls at nothing.
template <class Real>
void Threads<Real>::add_cables_of(std::size_t number) {
  Thread& thread = state_.threads[number];
  std::vector<Index> points(thread.bites.size(), -1);
  const auto point_of = [&](Index bite) {
    Index& point = points[std::size_t(bite)];
    if (point < 0) {
      point = cables_.add_point(thread.material.holds);
      sources_.push_back({number, bite, {}});
    }
    return point;
  };
  std::vector<SpanSource> spans;
  std::vector<Index> through;
  bool is_whole = true;
  const auto add_spans = [&](Index from, Index to) {
    for (Index i = from; i < to; ++i) {
      spans.push_back({number, &thread.spans[std::size_t(i)], i});
      is_whole = is_whole && !thread.spans[std::size_t(i)].is_cut;
    }
    for (Index i = from; i <= to; ++i) through.push_back(point_of(i));
  };
  const auto add = [&](bool is_closed) {
    if (is_whole && !spans.empty()) add_chain(number, spans, through, is_closed);
    spans.clear();
    through.clear();
    is_whole = true;
  };
  Index end = -1;  // the last knot
  for (ThreadKnot& knot : thread.knots) {
    if (end >= 0) {
      add_spans(end, knot.from);
      add(false);
    }
    add_spans(knot.from, knot.to);
    spans.push_back({number, &knot.closing, -1});
    add(true);
    end = knot.to;
  }
  if (!thread.hand.holds || thread.runs_through()) return;
  const Index hand = cables_.add_point();
  sources_.push_back({number, -1, {}});
  if (end < 0) {
    spans.push_back({number, &thread.hand.head, -1});
    through.push_back(hand);
  }
  add_spans(std::max(end, Index(0)), Index(thread.bites.size()) - 1);
  spans.push_back({number, &thread.hand.tail, -1});
  through.push_back(hand);
  add(false);
}

template <class Real>
void Threads<Real>::add_chain(std::size_t thread, const std::vector<SpanSource>& spans,
                              const std::vector<Index>& points, bool is_closed) {
  const ThreadMaterial& material = state_.threads[thread].material;
  std::vector<Cables::Span> cables;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    Cables::Span& cable = cables.emplace_back();
    cable.p = points[i];
    cable.q = points[(i + 1) % points.size()];
    cable.stiffness = material.stiffness;
    cable.friction = material.friction;
    cable.length = spans[i].span->length;
    cable.tension = spans[i].span->tension;
    cable.slip = spans[i].span->slip;
  }
  cables_.add_chain(cables, is_closed);
  span_sources_.insert(span_sources_.end(), spans.begin(), spans.end());
}

template <class Real>
Vec3d Threads<Real>::mobility(const Model& model, Index a, Index b) const {
  const Source &first = sources_[std::size_t(a)], &second = sources_[std::size_t(b)];
  Vec3d sum = Vec3d::Zero();
  if (first.bite < 0 || second.bite < 0) return sum;
  const auto point = [&](const Source& source) -> const EmbeddedPoint& {
    return state_.threads[source.thread].bites[std::size_t(source.bite)].point;
  };
  const EmbeddedPoint &p = point(first), &q = point(second);
  const Eigen::Vector4i at = model.elements.topology.corners(p.tet),
                        other = model.elements.topology.corners(q.tet);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k)
      if (at[i] == other[k]) sum += p.weights[i] * q.weights[k] * inverse_mass_.col(at[i]);
  return sum;
}

template <class Real>
Vec3d Threads<Real>::hand_at(const ThreadHand& hand, double time) const {
  const double share = duration_ > 0 ? std::clamp((time - begin_) / duration_, 0.0, 1.0) : 1;
  if (share > 1 - 1e-9) return hand.to;  // exactly, as a term that was loaded has it between two frames
  return hand.from + share * (hand.to - hand.from);
}

// Where the points of the cables are; with f, also the velocities that they would have without the cables.
template <class Real>
void Threads<Real>::place_points(const At& at, const Mat3X<Real>* f) {
  const Elements& elements = at.model.elements;
  for (std::size_t p = 0; p < sources_.size(); ++p) {
    const Source& source = sources_[p];
    const Thread& thread = state_.threads[source.thread];
    Cables::Point& point = cables_.points()[p];
    if (source.bite < 0) {
      point.x = hand_at(thread.hand, at.time);
      if (f) point.v = (hand_at(thread.hand, at.time + at.kick.dt) - point.x) / at.kick.dt;
      continue;
    }
    const EmbeddedPoint& place = thread.bites[std::size_t(source.bite)].point;
    point.x = position(place, elements, at.u);
    if (!f) continue;
    const Eigen::Vector4i corners = elements.topology.corners(place.tet);
    point.v.setZero();
    for (int c = 0; c < 4; ++c) {
      const Vec3d v = at.v.col(corners[c]).template cast<double>(),
                  force = f->col(corners[c]).template cast<double>(), inverse = inverse_mass_.col(corners[c]);
      for (int i = 0; i < 3; ++i)
        point.v[i] += place.weights[c] *
                      (inverse[i] == 0 ? v[i] : at.kick.keep * v[i] + at.kick.push * inverse[i] * force[i]);
    }
  }
}

// ---- Forces

// Outside of steps the tensions are those of the last one.
template <class Real>
void Threads<Real>::add_forces(const At& at, Mat3X<Real>& f) {
  on_tools_.clear();
  if (state_.threads.empty()) return;
  const bool is_step = at.kick.dt > 0;
  time_ = at.time;
  if (is_step) perform_plans(at);
  if (is_step)
    for (Thread& thread : state_.threads)
      if (thread.runs_through()) draw_through(thread, at);
  arrange();
  if (cables_.empty()) return;
  place_points(at, is_step ? &f : nullptr);
  if (is_step) {
    if (!is_coupled_) cables_.couple([&](Index a, Index b) { return mobility(at.model, a, b); });
    is_coupled_ = true;
    cables_.solve(at.kick.dt, at.kick.push);
    is_solved_ = true;
  } else {
    cables_.place();
    cables_.sum_forces();
  }
  for (std::size_t p = 0; p < sources_.size(); ++p) {
    Source& source = sources_[p];
    if (source.bite < 0) continue;
    const Cables::Point& point = cables_.points()[p];
    const EmbeddedPoint& place = state_.threads[source.thread].bites[std::size_t(source.bite)].point;
    add_force(place, at.model.elements.topology, point.force, f);
    if (is_step && point.way > 0)
      source.moved =
          moved_through(place, Vec3d(point.x + point.way * point.along), at.model.elements, grains_, at.u);
  }
  add_forces_on_tools();
}

template <class Real>
void Threads<Real>::add_diagonal_stiffness(const At& at, DiagonalStiffness& K) {
  if (state_.threads.empty()) return;
  arrange();
  place_points(at, nullptr);
  cables_.place();
  for (const Cables::Span& span : cables_.spans()) {
    if (span.tension == 0) continue;
    const Mat3<double> across = 2 * span.tension / std::max(span.stretched, Cables::shortest) *
                                (Mat3<double>::Identity() - span.along * span.along.transpose());
    for (const Index p : {span.p, span.q}) {
      const Source& source = sources_[std::size_t(p)];
      if (source.bite < 0) continue;
      const EmbeddedPoint& place = state_.threads[source.thread].bites[std::size_t(source.bite)].point;
      const Eigen::Vector4i corners = at.model.elements.topology.corners(place.tet);
      for (int c = 0; c < 4; ++c)
        for (int i = 0, entry = 0; i < 3; ++i)
          for (int k = i; k < 3; ++k, ++entry)
            K(entry, corners[c]) += std::abs(place.weights[c]) * across(i, k);
    }
  }
}

template <class Real>
double Threads<Real>::energy(const At& at) {
  if (state_.threads.empty()) return 0;
  arrange();
  place_points(at, nullptr);
  cables_.place();
  return cables_.energy();
}

template <class Real>
std::vector<Index> Threads<Real>::acts_on(const Model& model) const {
  std::vector<Index> vertices;
  for (const Thread& thread : state_.threads)
    for (const ThreadBite& bite : thread.bites) {
      const Topology& topology = model.elements.topology;
      if (bite.point.tet >= topology.tet_count() || !topology.alive(bite.point.tet))
        throw InputError("checkpoint", "has a thread in tetrahedron " + std::to_string(bite.point.tet) +
                                           ", which the body does not have");
      const bool is_due = !thread.plans.empty() && thread.plans.front().at <= due_;
      if (!thread.may_be_taut() && !is_due) continue;
      for (const Index v : model.elements.topology.corners(bite.point.tet)) vertices.push_back(v);
    }
  return vertices;
}

// ---- After a step

template <class Real>
void Threads<Real>::take_back_steps() {
  state_ = saved_;
  is_arranged_ = is_solved_ = false;
}

template <class Real>
void Threads<Real>::end_step(double, double dt) {
  if (!std::exchange(is_solved_, false)) return;
  const Cables::Losses losses = cables_.slip();
  state_.ledger.friction += losses.friction;
  state_.ledger.cut += losses.cut;
  for (std::size_t p = 0; p < sources_.size(); ++p)
    if (sources_[p].bite < 0) state_.ledger.hand -= cables_.points()[p].force.dot(cables_.points()[p].v) * dt;
  for (std::size_t s = 0; s < span_sources_.size(); ++s) {
    ThreadSpan& span = *span_sources_[s].span;
    const Cables::Span& found = cables_.spans()[s];
    span.length = found.length;
    span.tension = found.tension;
    span.slip = found.slip;
  }
  tighten_knots(dt);
  for (std::size_t s = 0; s < span_sources_.size(); ++s)
    cables_.spans()[s].length = span_sources_[s].span->length;
  break_threads();
  move_bites();
}

template <class Real>
void Threads<Real>::tighten_knots(double dt) {
  for (Thread& thread : state_.threads)
    for (ThreadKnot& knot : thread.knots) {
      if (knot.to_tighten == 0) continue;
      const double drawn = std::min(knot.to_tighten, knot.rate * dt);
      knot.to_tighten -= drawn;
      knot.closing.length -= drawn;
      const double T = knot.closing.tension;
      state_.ledger.hand += (T + T * T / (2 * thread.material.stiffness)) * drawn;
    }
}

template <class Real>
void Threads<Real>::break_threads() {
  std::size_t broken = state_.threads.size();  // one break per thread and step
  for (std::size_t s = 0; s < span_sources_.size(); ++s) {
    const SpanSource source = span_sources_[s];
    Thread& thread = state_.threads[source.thread];
    const double tension = cables_.spans()[s].tension;
    if (!(tension > thread.material.strength) || source.thread == broken) continue;
    broken = source.thread;
    is_arranged_ = false;
    std::string where = thread.is_on_needle() ? "at the needle" : "in the hand";
    if (source.after >= 0) {
      where = "after bite " + std::to_string(thread.bites[std::size_t(source.after)].number);
      thread.cut_after(source.after);
    } else {
      const auto is_it = [&](const ThreadKnot& knot) { return &knot.closing == source.span; };
      if (std::erase_if(thread.knots, is_it) > 0)
        where = "at a knot";
      else
        thread.cut_after(Index(thread.bites.size()) - 1);
    }
    const Vec3d place = cables_.points()[std::size_t(cables_.spans()[s].p)].x;
    report(Event::Kind::broken, thread, place, tension, "broke " + where + " at " + rounded(tension) + " N");
  }
}

// Bites that have given way lie elsewhere; those that came to the surface have torn out. Later bites of a
// thread come first, so that the places of the others stay.
template <class Real>
void Threads<Real>::move_bites() {
  torn_.clear();
  for (std::size_t p = 0; p < sources_.size(); ++p) {
    const Source& source = sources_[p];
    const Cables::Point& point = cables_.points()[p];
    if (source.bite < 0 || point.way == 0) continue;
    if (source.moved.tet >= 0) {
      state_.threads[source.thread].bites[std::size_t(source.bite)].point = source.moved;
      is_coupled_ = false;
    } else {
      torn_.push_back({source.thread, source.bite, point.x});
    }
  }
  std::sort(torn_.begin(), torn_.end(), [](const Torn& a, const Torn& b) {
    return std::tuple(a.thread, a.bite) > std::tuple(b.thread, b.bite);
  });
  for (const auto& [number, bite, place] : torn_) {
    Thread& thread = state_.threads[number];
    report(Event::Kind::torn, thread, place, 0,
           "has torn out of the tissue at bite " + std::to_string(thread.bites[std::size_t(bite)].number) +
               ", which held " + rounded(thread.material.holds) + " N");
    thread.remove_bite(bite);
    is_arranged_ = false;
  }
}

// ---- Cuts

template <class Real>
void Threads<Real>::follow(const Topology& topology, const MeshEdit&) {
  for (Thread& thread : state_.threads)
    for (auto i = Index(thread.bites.size()); i-- > 0;) {
      const ThreadBite bite = thread.bites[std::size_t(i)];
      if (exists(bite.point, topology)) continue;
      thread.remove_bite(i);
      report(Event::Kind::torn, thread, {}, 0,
             "has lost the tissue around bite " + std::to_string(bite.number));
      is_arranged_ = false;
    }
  is_coupled_ = false;
}

template <class Real>
void Threads<Real>::follow_grains(const Elements& elements, const Grains& grains, const MeshEdit& edit) {
  for (Thread& thread : state_.threads)
    for (ThreadBite& bite : thread.bites) follow_division(bite.point, elements, grains, edit);
}

template <class Real>
NewTerm<Real> StitchSetup::make_term(const Setup& setup) {
  return std::make_shared<Threads<Real>>(setup);
}
template NewTerm<float> StitchSetup::make_term(const Setup&);
template NewTerm<double> StitchSetup::make_term(const Setup&);

template class Threads<float>;
template class Threads<double>;

}  // namespace lobe
