// What is done to threads: by commands, and by the plans of a scene.
#include <algorithm>
#include <cmath>

#include "lobe/error.h"
#include "lobe/forces/threads.h"
#include "lobe/text.h"

namespace lobe {
namespace {

std::string named(const Thread& thread) { return "thread \"" + thread.name + "\""; }

[[noreturn]] void refuse(const Thread& thread, const std::string& why) {
  throw InputError(named(thread), why);
}

// The place of a bite by its number. Numbers below 0 count from the last one, which is −1.
Index place_of(const Thread& thread, Index number) {
  const auto count = Index(thread.bites.size());
  const Index place = number >= 0 ? thread.find(number) : std::max(count + number, Index(-1));
  if (place < 0)
    refuse(thread,
           count == 0 ? "passes no tissue" : "has no bite " + std::to_string(number) + ", or not any more");
  return place;
}

void draw_in(ThreadKnot& knot, double length, double over) {
  if (over > 0) {
    knot.to_tighten += length;
    knot.rate = knot.to_tighten / over;
  } else {
    knot.closing.length -= length;
  }
}

template <class At>
double way_between(const Thread& thread, Index a, Index b, const At& at) {  // of two bites [m]
  const auto place = [&](Index i) {
    return position(thread.bites[std::size_t(i)].point, at.model.elements, at.u);
  };
  return (place(b) - place(a)).norm();
}

}  // namespace

// ---- Commands

template <class Real>
Thread& Threads<Real>::find(int number) {
  for (Thread& thread : state_.threads)
    if (thread.number == number) return thread;
  throw InputError("thread " + std::to_string(number), "there is none of this number");
}

template <class Real>
void Threads<Real>::bring(int number, const ThreadMaterial& material) {
  const std::string whose = "thread " + std::to_string(number);
  if (number < 0) throw InputError(whose, "a number must be at least 0");
  for (const Thread& thread : state_.threads)
    if (thread.number == number) throw InputError(whose, "there is one of this number already");
  material.check(
      [](bool holds, const std::string& fault) {
        if (!holds) throw InputError("thread", fault);
      },
      whose);
  Thread thread;
  thread.number = number;
  thread.name = std::to_string(number);
  thread.material = material;
  thread.is_sewn = true;
  const auto after = std::find_if(state_.threads.begin(), state_.threads.end(),
                                  [&](const Thread& other) { return other.number > number; });
  state_.threads.insert(after, std::move(thread));
  is_arranged_ = false;
}

template <class Real>
Thread& Threads<Real>::find_for_bite(int number, const EmbeddedPoint& point, const At& at) {
  Thread& thread = find(number);
  if (!thread.is_sewn) refuse(thread, "is not sewn yet");
  if (!point.is_valid() || !exists(point, at.model.elements.topology))
    refuse(thread, "cannot pass tetrahedron " + std::to_string(point.tet) +
                       ": it does not exist, or the weights do not have the sum 1");
  return thread;
}

template <class Real>
void Threads<Real>::bite(int number, const EmbeddedPoint& point, const At& at) {
  Thread& thread = find_for_bite(number, point, at);
  if (thread.is_on_needle()) refuse(thread, "is on a needle, which makes its bites");
  thread.bites.push_back({point, thread.next_number()});
  const auto last = Index(thread.bites.size()) - 1;
  if (last > 0) {
    thread.spans.emplace_back().length = way_between(thread, last - 1, last, at);
  }
  const Vec3d x = position(point, at.model.elements, at.u);
  if (thread.hand.holds) thread.hand.tail.length = (thread.hand.to - x).norm();
  is_arranged_ = false;
}

// What is slack between two bites lies straight.
template <class Real>
void Threads<Real>::lengthen_to_fit(Thread& thread, Index from, Index to, const At& at) {
  for (Index i = from; i < to; ++i) {
    ThreadSpan& span = thread.spans[std::size_t(i)];
    if (span.tension == 0) span.length = way_between(thread, i, i + 1, at);
  }
}

template <class Real>
bool Threads<Real>::lead(int number, const Vec3d& point) {
  const auto is_led = [&](const Thread& thread) {
    return thread.number == number && thread.hand.holds && !thread.is_on_needle();
  };
  const auto thread = std::find_if(state_.threads.begin(), state_.threads.end(), is_led);
  if (thread == state_.threads.end() || !point.allFinite()) return false;
  thread->hand.target = point;
  return true;
}

template <class Real>
void Threads<Real>::pull(int number, bool on, const Vec3d& point, const At& at) {
  Thread& thread = find(number);
  ThreadHand& hand = thread.hand;
  if (!point.allFinite()) refuse(thread, "is pulled to a point that is not finite");
  if (!thread.is_sewn || thread.bites.empty()) refuse(thread, "passes no tissue yet: it cannot be pulled");
  if (thread.is_on_needle()) refuse(thread, "is on a needle, which draws it: cut it off, or take that away");
  if (on && lead(number, point)) return;
  if (on) {
    hand = {true, point, point, point, {}, {}};
    const auto place = [&](const ThreadBite& bite) { return position(bite.point, at.model.elements, at.u); };
    hand.tail.length = (point - place(thread.bites.back())).norm();
    hand.head.length = (point - place(thread.bites.front())).norm();
    lengthen_to_fit(thread, thread.knots.empty() ? 0 : thread.knots.back().to, Index(thread.spans.size()),
                    at);
  }
  hand.holds = on;
  is_arranged_ = false;
}

// A knot that is there already is drawn together further.
template <class Real>
void Threads<Real>::tie(int number, Index from, Index to, double tighten, double over, const At& at) {
  Thread& thread = find(number);
  if (!thread.is_sewn) refuse(thread, "is not sewn yet");
  if (!(tighten >= 0 && std::isfinite(tighten) && over >= 0 && std::isfinite(over)))
    refuse(thread, "is tightened by a length or in a time that is below 0 or not finite");
  from = place_of(thread, from);
  to = place_of(thread, to);
  const auto is_it = [&](const ThreadKnot& knot) { return knot.from == from && knot.to == to; };
  const auto present = std::find_if(thread.knots.begin(), thread.knots.end(), is_it);
  const bool is_tied = present != thread.knots.end() && tighten > 0;
  if (const std::string fault = thread.fault_of_tie(from, to); !is_tied && !fault.empty())
    refuse(thread, fault);
  if (!is_tied) lengthen_to_fit(thread, from, to, at);
  const double closing =
      is_tied ? present->closing.length - present->to_tighten : way_between(thread, from, to, at);
  double path = closing;
  for (Index i = from; i < to; ++i) path += thread.spans[std::size_t(i)].length;
  if (tighten > path / 2)
    refuse(thread, "is tightened by " + rounded(tighten) + " m, more than half of its loop of " +
                       rounded(path) + " m");
  if (is_tied)
    draw_in(*present, tighten, over);
  else
    thread.tie(from, to, closing, tighten, over);
  is_arranged_ = false;
}

template <class Real>
void Threads<Real>::cut(int number, Index after) {
  Thread& thread = find(number);
  thread.cut_after(place_of(thread, after));
  is_arranged_ = false;
}

// ---- Plans of a scene. They are performed in the first step of a frame.

template <class Real>
void Threads<Real>::begin_frame(double time, double duration) {
  begin_ = time;
  duration_ = duration;
  due_ = time;
  for (Thread& thread : state_.threads) {
    thread.hand.from = thread.hand.to;
    thread.hand.to = thread.hand.target;
    const bool is_tied = !thread.plans.empty() && thread.plans.front().at <= due_;
    has_changed_ = has_changed_ || is_tied || (!thread.is_sewn && thread.at <= due_);
  }
}

template <class Real>
void Threads<Real>::perform_plans(const At& at) {
  for (Thread& thread : state_.threads) {
    if (!thread.is_sewn && thread.at <= due_) sew(thread, at);
    while (thread.is_sewn && !thread.plans.empty() && thread.plans.front().at <= due_) {
      const TieSetup plan = thread.plans.front();
      thread.plans.erase(thread.plans.begin());
      tie_planned(thread, plan, at);
    }
  }
}

template <class Real>
void Threads<Real>::sew(Thread& thread, const At& at) {
  thread.is_sewn = true;
  is_arranged_ = false;
  lengthen_to_fit(thread, 0, Index(thread.spans.size()), at);
}

template <class Real>
void Threads<Real>::tie_planned(Thread& thread, const TieSetup& plan, const At& at) {
  try {
    tie(thread.number, plan.from, plan.to, plan.tighten, plan.over, at);
  } catch (const InputError& error) {
    const Vec3d place = position(thread.bites.front().point, at.model.elements, at.u);
    report(Event::Kind::torn, thread, place, 0, "is not tied: it " + error.faults().front().message);
  }
}

template <class Real>
void Threads<Real>::report(Event::Kind kind, const Thread& thread, const std::optional<Vec3d>& place,
                           double size, const std::string& what) {
  state_.events.push_back({kind, time_, place, size, named(thread) + " " + what});
}

}  // namespace lobe
