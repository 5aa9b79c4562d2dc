// Threads at the ends of needles. As long as nothing fixes its other end such a thread runs through its bites
// as the needle draws, and pulls at nothing. Behind a knot it is taut like one that a hand pulls.
#include <algorithm>

#include "lobe/error.h"
#include "lobe/forces/threads.h"

namespace lobe {

// Bites are those of the last frame: the needle's end is where this one begins.
template <class Real>
void Threads<Real>::bite_by_needle(const NeedleThread& by, const EmbeddedPoint& point, const NeedleEnd& end,
                                   const At& at) {
  Thread& thread = find_for_bite(by.number, point, at);
  if (thread.hand.holds && thread.hand.needle != end.tool)
    throw InputError("thread \"" + thread.name + "\"", "is in a hand, or on another needle");
  const bool begins = !thread.hand.holds;
  if (thread.length == 0) {
    thread.length = by.length;
    thread.plan(by.ties);
  }
  const auto place = [&](const ThreadBite& bite) { return position(bite.point, at.model.elements, at.u); };
  ThreadHand& hand = thread.hand;
  thread.bites.push_back({point, thread.next_number()});
  const Vec3d x = place(thread.bites.back());
  const double to_end = (end.from - x).norm();
  if (thread.bites.size() > 1) {
    const double way = (x - place(thread.bites[thread.bites.size() - 2])).norm();
    ThreadSpan& span = thread.spans.emplace_back();
    span.is_cut = begins;
    span.length = way;
    // What is slack lies before the tissue; what is taut, on both sides of it.
    if (!begins && way + to_end > 0)
      span.length = std::max(hand.tail.length * way / (way + to_end), hand.tail.length - to_end);
  }
  const double left = hand.tail.length - (thread.spans.empty() ? 0 : thread.spans.back().length);
  hand.tail.length = begins ? to_end : std::max(0.0, left);
  hand.holds = true;
  hand.needle = end.tool;
  follow_needle(end);
  is_arranged_ = false;
}

template <class Real>
std::vector<int> Threads<Real>::needles() const {
  std::vector<int> tools;
  for (const Thread& thread : state_.threads)
    if (thread.is_on_needle()) tools.push_back(thread.hand.needle);
  return tools;
}

template <class Real>
void Threads<Real>::follow_needle(const NeedleEnd& end) {
  for (Thread& thread : state_.threads) {
    if (thread.hand.needle != end.tool || !thread.is_on_needle()) continue;
    thread.hand.from = end.from;
    thread.hand.to = thread.hand.target = end.to;
    thread.hand.arm = end.arm;
  }
}

template <class Real>
void Threads<Real>::leave_needle(int tool) {
  for (Thread& thread : state_.threads)
    if (thread.is_on_needle() && thread.hand.needle == tool) thread.leave_needle();
  is_arranged_ = false;
}

// For the step that follows.
template <class Real>
void Threads<Real>::draw_through(Thread& thread, const At& at) {
  const auto place = [&](const ThreadBite& bite) { return position(bite.point, at.model.elements, at.u); };
  ways_.clear();
  for (std::size_t i = 0; i + 1 < thread.bites.size(); ++i)
    ways_.push_back((place(thread.bites[i + 1]) - place(thread.bites[i])).norm());
  const double way = (hand_at(thread.hand, at.time + at.kick.dt) - place(thread.bites.back())).norm();
  const Vec3d first = place(thread.bites[std::size_t(thread.first_on_needle())]);
  const Index slipped = thread.draw_through(way, ways_);
  if (slipped < 0) return;
  is_arranged_ = false;
  report(Event::Kind::drawn_out, thread, first, 0,
         "was drawn too far: its end has come out of bite " + std::to_string(slipped));
}

template <class Real>
void Threads<Real>::add_forces_on_tools() {
  for (std::size_t p = 0; p < sources_.size(); ++p) {
    const ThreadHand& hand = state_.threads[sources_[p].thread].hand;
    if (sources_[p].bite >= 0 || hand.needle == 0) continue;
    const Vec3d force = -cables_.points()[p].force;  // on the thread
    on_tools_.push_back({.tool = hand.needle, .force = force, .torque = hand.arm.cross(force)});
  }
}

}  // namespace lobe
