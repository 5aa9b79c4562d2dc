#include "lobe/forces/thread.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lobe {

Thread planned(const StitchSetup& stitch, int number) {
  Thread thread;
  thread.number = number;
  thread.name = stitch.name;
  thread.material = stitch.material;
  thread.at = stitch.at;
  thread.plan(stitch.ties);
  for (const EmbeddedPoint& point : stitch.bites) thread.bites.push_back({point, Index(thread.bites.size())});
  thread.spans.resize(thread.bites.size() - 1);
  return thread;
}

void Thread::plan(const std::vector<TieSetup>& ties) {
  plans = ties;
  std::stable_sort(plans.begin(), plans.end(),
                   [](const TieSetup& a, const TieSetup& b) { return a.at < b.at; });
}

bool Thread::is_valid() const {
  const auto count = Index(bites.size());
  bool valid = spans.size() == (bites.empty() ? 0 : bites.size() - 1) && hand.from.allFinite() &&
               hand.to.allFinite() && hand.target.allFinite() && (!hand.holds || !bites.empty()) &&
               hand.needle >= 0 && (hand.needle == 0 || hand.holds) && hand.arm.allFinite() && length >= 0 &&
               std::isfinite(length);
  Index number = -1;
  for (const ThreadBite& bite : bites) {
    valid = valid && bite.number > number && bite.number < std::numeric_limits<Index>::max();
    number = bite.number;
  }
  Index before = 0;
  for (const ThreadKnot& knot : knots) {
    valid = valid && knot.from >= before && knot.from < knot.to && knot.to < count && knot.to_tighten >= 0 &&
            std::isfinite(knot.to_tighten) && knot.rate >= 0 && std::isfinite(knot.rate);
    before = knot.to;
  }
  material.check([&](bool holds, const std::string&) { valid = valid && holds; }, "");
  return valid;
}

Index Thread::find(Index number) const {
  for (std::size_t i = 0; i < bites.size(); ++i)
    if (bites[i].number == number) return Index(i);
  return -1;
}

Index Thread::next_number() const {
  return bites.empty() ? 0 : bites.back().number + 1;  // they ascend
}

void Thread::remove_bite(Index at) {
  const Index last = Index(bites.size()) - 1;
  const double before = at > 0 ? spans[std::size_t(at) - 1].length : 0,
               behind = at < last ? spans[std::size_t(at)].length : 0;
  const bool leaves_needle = is_on_needle() && at == last && first_on_needle() == last;
  for (ThreadKnot& knot : knots) {  // what led to the bite stays in its loop
    if (at == knot.from) knot.closing.length += behind;
    if (at == knot.to) knot.closing.length += before;
  }
  if (at == 0) hand.head.length += behind;
  if (at == last) hand.tail.length += before;
  bites.erase(bites.begin() + at);
  if (!spans.empty()) {
    const bool is_inner = at > 0 && at < Index(spans.size());
    if (is_inner) {
      spans[std::size_t(at) - 1].length += spans[std::size_t(at)].length;
      spans[std::size_t(at) - 1].slip = 0;
      spans[std::size_t(at) - 1].is_cut |= spans[std::size_t(at)].is_cut;
    }
    spans.erase(spans.begin() + std::min(at, Index(spans.size()) - 1));
  }
  for (ThreadKnot& knot : knots) {
    if (at < knot.from) --knot.from;
    if (at <= knot.to) --knot.to;
  }
  std::erase_if(knots, [](const ThreadKnot& knot) { return knot.to <= knot.from; });
  if (leaves_needle) hand = {};
  if (bites.empty()) hand.holds = false;
}

// What is behind the cut stays on the needle.
void Thread::cut_after(Index at) {
  if (is_on_needle() && at >= first_on_needle()) {
    length = hand.tail.length;
    for (auto i = std::size_t(at); i < spans.size(); ++i) length += spans[i].length;
  }
  std::erase_if(knots, [&](const ThreadKnot& knot) { return knot.from <= at && at < knot.to; });
  if (at < Index(spans.size()))
    spans[std::size_t(at)].is_cut = true;
  else {
    hand.holds = false;
    hand.needle = 0;
  }
}

void Thread::tie(Index from, Index to, double closing, double tighten, double over) {
  ThreadKnot knot{from, to, {}, tighten, 0};
  knot.closing.length = closing;
  if (over > 0)
    knot.rate = tighten / over;
  else {
    knot.closing.length -= tighten;
    knot.to_tighten = 0;
  }
  const auto after =
      std::find_if(knots.begin(), knots.end(), [&](const ThreadKnot& other) { return other.from >= to; });
  knots.insert(after, knot);
  if (!is_on_needle()) hand.holds = false;
}

// ---- On a needle

Index Thread::first_on_needle() const {
  auto first = Index(spans.size());
  while (first > 0 && !spans[std::size_t(first) - 1].is_cut) --first;
  return first;
}

bool Thread::runs_through() const {
  return is_on_needle() && (knots.empty() || knots.back().to < first_on_needle());
}

double Thread::free_length() const {
  double left = length - hand.tail.length;
  for (auto i = std::size_t(first_on_needle()); i < spans.size(); ++i) left -= spans[i].length;
  return left;
}

Index Thread::draw_through(double way, const std::vector<double>& ways) {
  const auto first = std::size_t(first_on_needle());
  double drawn = std::max(0.0, way - hand.tail.length);  // out of the span before
  hand.tail.length += drawn;
  for (std::size_t i = spans.size(); i-- > first;) {
    const double left = spans[i].length - drawn;
    drawn = std::max(0.0, ways[i] - left);
    spans[i].length = left + drawn;
    spans[i].tension = 0;
    spans[i].slip = 0;
  }
  hand.tail.tension = 0;
  Index slipped = -1;
  while (is_on_needle() && free_length() < 0) {
    slipped = bites[std::size_t(first_on_needle())].number;
    remove_bite(first_on_needle());
  }
  return slipped;
}

void Thread::leave_needle() {
  hand = {};
  length = 0;
}

std::string Thread::fault_of_tie(Index from, Index to) const {
  if (from < 0 || to >= Index(bites.size()) || from >= to)
    return "has " + std::to_string(bites.size()) + (bites.size() == 1 ? " bite" : " bites") +
           ": a knot is between two of them, in their order";
  for (Index s = from; s < to; ++s)
    if (spans[std::size_t(s)].is_cut)
      return "was cut after bite " + std::to_string(bites[std::size_t(s)].number) +
             ": what is cut cannot be tied";
  for (const ThreadKnot& knot : knots)
    if (from < knot.to && knot.from < to) return "has a knot there already";
  return "";
}

}  // namespace lobe
