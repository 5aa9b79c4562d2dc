#include "lobe/skin/divide_triangle.h"

#include <algorithm>
#include <cstddef>

namespace lobe {
namespace {

struct Arc {
  std::vector<int> points;  // of the rim, from where a line crosses it to where the next does
  Index first, last;        // what lies under its ends
};

class Rim {
 public:
  explicit Rim(const std::vector<RimPoint>& points) : points_(points) {
    for (int i = 0; i < count(); ++i)
      if ((*this)[i].share > 0) crossings_.push_back(i);
  }

  int count() const { return static_cast<int>(points_.size()); }
  const RimPoint& operator[](int i) const { return points_[std::size_t(i)]; }
  const std::vector<int>& crossings() const { return crossings_; }

  std::array<int, 3> crossings_of_sides() const {
    std::array<int, 3> counts{};
    for (int i : crossings_) ++counts[std::size_t((*this)[i].side)];
    return counts;
  }

  std::vector<Arc> arcs() const {
    std::vector<Arc> found;
    for (std::size_t k = 0; k < crossings_.size(); ++k) {
      const int begin = crossings_[k], end = crossings_[(k + 1) % crossings_.size()];
      Arc& arc = found.emplace_back(Arc{{begin}, (*this)[begin].after, (*this)[end].before});
      for (int i = begin; i != end;) arc.points.push_back(i = (i + 1) % count());
    }
    return found;
  }

 private:
  const std::vector<RimPoint>& points_;
  std::vector<int> crossings_;
};

// A single line leads to the opposite corner. If there are several, what is between them would be connected
// to nothing under the rest of the rim, so it stays with the rest.
std::vector<TrianglePart> fan_from_opposite(const Rim& rim, int side) {
  int opposite = 0, begin = 0;
  for (int i = 0; i < rim.count(); ++i) {
    if (rim[i].share > 0) continue;
    if (rim[i].side == side) begin = i;
    if (rim[i].side == (side + 2) % 3) opposite = i;
  }
  const int first = rim.crossings().front(), last = rim.crossings().back();
  const auto element_at = [&](int i, bool is_end) {  // of a part of the side
    if (rim[i].share == 0) return rim[i].after;
    if (first == last) return is_end ? rim[i].before : rim[i].after;
    return i == last ? rim[i].after : rim[first].before;
  };
  std::vector<TrianglePart> parts;
  for (int i = begin, next = 0;; i = next) {
    next = (i + 1) % rim.count();
    parts.push_back(
        {{i, next, opposite}, {element_at(i, false), element_at(next, true), rim[opposite].after}});
    if (rim[next].share == 0) return parts;
  }
}

// Finds the arc that takes what is left in the middle: one that has nothing else, if there is one.
std::size_t arc_of_middle(const std::vector<Arc>& arcs, Index middle,
                          const std::function<bool(Index, Index)>& on_one_side) {
  const auto is_bare = [](const Arc& arc) { return arc.points.size() == 2; };
  const bool any_bare = std::any_of(arcs.begin(), arcs.end(), is_bare);
  std::size_t found = arcs.size();
  for (std::size_t k = 0; k < arcs.size(); ++k) {
    if (any_bare && !is_bare(arcs[k])) continue;
    if (on_one_side(arcs[k].first, middle) || on_one_side(arcs[k].last, middle)) return k;
    if (found == arcs.size()) found = k;
  }
  return found;
}

// A fan of the points where lines cross the rim, from one that has the fewest others on its side.
void add_middle(const Rim& rim, const std::vector<Arc>& arcs, std::size_t chosen,
                const std::function<bool(Index, Index)>& on_one_side, std::vector<TrianglePart>& parts) {
  const std::vector<int>& crossings = rim.crossings();
  const std::size_t count = crossings.size();
  std::vector<Index> elements(count, arcs[chosen].first);
  for (std::size_t k = 0; k < count; ++k) {
    const RimPoint& own = rim[crossings[k]];
    if (k == chosen || k == (chosen + 1) % count)
      elements[k] = k == chosen ? own.after : own.before;
    else if (on_one_side(own.after, arcs[chosen].first))
      elements[k] = own.after;
    else if (on_one_side(own.before, arcs[chosen].first))
      elements[k] = own.before;
  }
  const std::array<int, 3> of_sides = rim.crossings_of_sides();
  const auto on_side = [&](int i) { return of_sides[std::size_t(rim[i].side)]; };
  const auto apex = std::size_t(std::min_element(crossings.begin(), crossings.end(),
                                                 [&](int i, int k) { return on_side(i) < on_side(k); }) -
                                crossings.begin());
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const std::array<std::size_t, 3> own{apex, (apex + k) % count, (apex + k + 1) % count};
    TrianglePart& part = parts.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      part.points[i] = crossings[own[i]];
      part.elements[i] = elements[own[i]];
    }
  }
}

}  // namespace

std::vector<TrianglePart> divide_triangle(const std::vector<RimPoint>& points, Index middle,
                                          const std::function<bool(Index, Index)>& on_one_side) {
  const Rim rim(points);
  const std::array<int, 3> of_sides = rim.crossings_of_sides();
  for (int side = 0; side < 3; ++side)
    if (of_sides[std::size_t(side)] == static_cast<int>(rim.crossings().size()))
      return fan_from_opposite(rim, side);
  std::vector<TrianglePart> parts;
  const std::vector<Arc> arcs = rim.arcs();
  for (const Arc& arc : arcs) {
    const auto element_at = [&](std::size_t k) {
      return k == 0 ? arc.first : k + 1 == arc.points.size() ? arc.last : rim[arc.points[k]].after;
    };
    for (std::size_t k = 1; k + 1 < arc.points.size(); ++k)
      parts.push_back({{arc.points[0], arc.points[k], arc.points[k + 1]},
                       {element_at(0), element_at(k), element_at(k + 1)}});
  }
  if (arcs.size() >= 3) add_middle(rim, arcs, arc_of_middle(arcs, middle, on_one_side), on_one_side, parts);
  return parts;
}

}  // namespace lobe
