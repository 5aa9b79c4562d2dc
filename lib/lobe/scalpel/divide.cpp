// What grains that have come apart mean for the simulation.
#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "lobe/scalpel/grains.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

using Corners = Eigen::Vector4i;
using GrainPair = std::pair<Index, Index>;

bool has(const Corners& corners, Index v) { return (corners.array() == v).any(); }

// Grains of the tetrahedra around a vertex hang together there if faces lead from one to another without
// leaving these tetrahedra: a face in common ties all three vertices of its tetrahedra's face together.
class Division {
 public:
  // `parted`: the grains on both sides of each face that has opened. `marks`: per grain, −1; so it is left.
  // `is_whole`: per vertex, whether the grains around it are known to have hung together before.
  // `sides`: per vertex, −1; so it is left, too.
  Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
           const std::vector<GrainPair>& parted, std::vector<Index>& marks, std::vector<Index>& sides,
           std::vector<std::uint8_t>& is_whole);
  ~Division() {
    for (const Changed& changed : changed_) marks_[std::size_t(changed.grain)] = -1;
    for (Index v : vertices_) first_side_[std::size_t(v)] = -1;
  }
  Division(const Division&) = delete;
  Division& operator=(const Division&) = delete;

  TetDivision find();
  // Grains, and the tetrahedra that they are part of now.
  std::vector<std::pair<Index, Index>> moved_grains() const;

 private:
  struct Changed {  // a grain whose tetrahedron will have another number or other corners
    Index grain, element;
    Corners corners;  // of its tetrahedron, as they will be
    bool has_new_corners = false;
    Index mark = -1;
  };
  struct Part {  // of a tetrahedron that was divided or has new corners
    Index tet;
    std::vector<Index> grains;
  };

  // Of a grain: its place in changed_; −1: none; below: the vertex around which it has not been found yet,
  // or has.
  static Index mark_around(Index v) { return -2 - 2 * v; }
  static Index mark_found(Index v) { return -3 - 2 * v; }
  Index& mark(Index grain) {
    Index& own = marks_[std::size_t(grain)];
    return own < 0 ? own : changed_[std::size_t(own)].mark;
  }
  const Changed* find_changed(Index grain) const {
    const Index place = marks_[std::size_t(grain)];
    return place < 0 ? nullptr : &changed_[std::size_t(place)];
  }
  Changed& changed(Index grain);
  Index element_of(Index grain) const {
    const Changed* changed = find_changed(grain);
    return changed ? changed->element : grains_[grain].element;
  }
  Corners corners_of(Index grain) const {
    const Changed* changed = find_changed(grain);
    return changed ? changed->corners : topology_.corners(grains_[grain].element);
  }

  template <class Visit>  // visit(pair, vertex) of both tetrahedra that the grains beside a face are part of
  void for_common_vertices(Visit&& visit) const {
    for (const GrainPair& pair : parted_) {
      const Corners a = topology_.corners(grains_[pair.first].element),
                    b = topology_.corners(grains_[pair.second].element);
      for (Index v : a)
        if (has(b, v)) visit(pair, v);
    }
  }
  void find_star(Index v);
  void find_rest(Index v, Index first);
  bool has_many_sides(Index v) const;
  bool is_bridged(Index v);
  bool was_whole(Index v);
  bool may_part() const;
  bool find_parts(Index v);
  void split(Index v);
  std::vector<Index> changed_tets() const;
  void divide(Index tet);
  void find_neighbours();
  void add_neighbours(Index tet, std::span<const Index> grains);

  const Grains& grains_;
  const Topology& topology_;
  const std::vector<GrainPair>& parted_;
  std::vector<Index>& marks_;
  std::vector<std::uint8_t>& is_whole_;
  std::vector<Index> touched_, vertices_;
  struct Side {         // a grain beside a face that opened
    Index grain, next;  // of the same vertex in sides_; −1: the last
  };
  std::vector<Side> sides_;
  std::vector<Index>& first_side_;  // per vertex, in sides_; −1: none
  std::vector<Changed> changed_;
  std::vector<Index> star_, front_;           // grains around a vertex; those found there
  std::vector<std::size_t> ends_;             // of connected parts, in front_
  std::vector<Part> parts_, new_parts_;       // by their numbers: of old tetrahedra, of new ones
  std::vector<Index> grains_of_tet_;          // scratch of divide()
  std::array<std::vector<Index>, 4> across_;  // scratch of add_neighbours()
  std::vector<Index> others_;                 // the same
  Index new_tets_ = 0;
  TetDivision result_;
};

Division::Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
                   const std::vector<GrainPair>& parted, std::vector<Index>& marks, std::vector<Index>& sides,
                   std::vector<std::uint8_t>& is_whole)
    : grains_(grains),
      topology_(topology),
      parted_(parted),
      marks_(marks),
      is_whole_(is_whole),
      touched_(touched),
      first_side_(sides) {
  constexpr Index none = -1, seen = -2;
  marks_.resize(std::size_t(grains.count()), -1);
  is_whole_.resize(std::size_t(topology.vertex_count()), 0);
  first_side_.resize(std::size_t(topology.vertex_count()), none);
  for (Index t : touched)
    for (Index v : topology.corners(t))
      if (std::exchange(first_side_[std::size_t(v)], seen) == none) vertices_.push_back(v);
  std::sort(vertices_.begin(), vertices_.end());
  for (Index v : vertices_) first_side_[std::size_t(v)] = none;
  sides_.reserve(8 * parted.size());
  for_common_vertices([&](const GrainPair& pair, Index v) {
    for (Index grain : {pair.first, pair.second}) {
      sides_.push_back({grain, first_side_[std::size_t(v)]});
      first_side_[std::size_t(v)] = static_cast<Index>(sides_.size()) - 1;
    }
  });
}

Division::Changed& Division::changed(Index grain) {
  Index& place = marks_[std::size_t(grain)];
  if (place < 0) {
    const Index element = grains_[grain].element;
    changed_.push_back({grain, element, topology_.corners(element), false, place});
    place = static_cast<Index>(changed_.size()) - 1;
  }
  return changed_[std::size_t(place)];
}

std::vector<std::pair<Index, Index>> Division::moved_grains() const {
  std::vector<std::pair<Index, Index>> moved;
  for (const Changed& changed : changed_)
    if (changed.element != grains_[changed.grain].element) moved.emplace_back(changed.grain, changed.element);
  std::sort(moved.begin(), moved.end());
  return moved;
}

TetDivision Division::find() {
  for (Index v : vertices_) split(v);
  result_.may_part = may_part();
  for (Index t : changed_tets()) divide(t);
  std::move(new_parts_.begin(), new_parts_.end(), std::back_inserter(parts_));
  find_neighbours();
  return std::move(result_);
}

void Division::find_star(Index v) {
  star_.clear();
  for (Index t : topology_.around(v)) {
    const std::span<const Index> own = grains_.of(t);
    star_.insert(star_.end(), own.begin(), own.end());
  }
  for (Index grain : star_) mark(grain) = mark_around(v);
}

// Adds what hangs together with a grain around a vertex and has not been found yet.
void Division::find_rest(Index v, Index first) {
  std::size_t at = front_.size();
  front_.push_back(first);
  mark(first) = -1;
  for (; at < front_.size() && front_.size() < star_.size(); ++at)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(front_[at], f);
      if (other < 0) continue;
      Index& of_other = mark(other);
      if (of_other != mark_around(v)) continue;
      of_other = -1;
      front_.push_back(other);
    }
}

// Whether grains that have been parted around a vertex still hang together there, around what has opened.
// What hung together before still does, then.
bool Division::is_bridged(Index v) {
  const Index first = first_side_[std::size_t(v)];
  if (first < 0) return true;
  Index missing = -1;
  for (Index side = first; side >= 0; side = sides_[std::size_t(side)].next)
    missing += std::exchange(mark(sides_[std::size_t(side)].grain), mark_around(v)) != mark_around(v);
  front_.assign(1, sides_[std::size_t(first)].grain);
  mark(front_.front()) = mark_found(v);
  for (std::size_t at = 0; at < front_.size() && missing > 0; ++at)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(front_[at], f);
      if (other < 0) continue;
      Index& of_other = mark(other);
      if (of_other == mark_found(v)) continue;
      if (of_other == mark_around(v))
        --missing;
      else if (!has(topology_.corners(grains_[other].element), v))
        continue;
      of_other = mark_found(v);
      front_.push_back(other);
    }
  for (Index grain : front_) mark(grain) = -1;
  for (Index side = first; side >= 0; side = sides_[std::size_t(side)].next)
    mark(sides_[std::size_t(side)].grain) = -1;
  return missing == 0;
}

// Asked once for each vertex: from then on it is.
bool Division::was_whole(Index v) { return std::exchange(is_whole_[std::size_t(v)], std::uint8_t(1)) != 0; }

// Whether a part of the body may have come off: there is a face that opened, and nothing around any of its
// vertices still holds both sides together.
bool Division::may_part() const {
  const auto is_split = [&](Index v) {
    return std::binary_search(result_.vertices.begin(), result_.vertices.end(), v);
  };
  std::size_t held = 0;
  const GrainPair* last = nullptr;
  for_common_vertices([&](const GrainPair& pair, Index v) {
    if (&pair == last || is_split(v)) return;
    last = &pair;
    ++held;
  });
  return held < parted_.size();
}

// Finds what hangs together around a vertex, in order of the first grains; whether these are several parts.
bool Division::find_parts(Index v) {
  find_star(v);
  front_.clear();
  ends_.clear();
  while (front_.size() < star_.size()) {
    Index first = std::numeric_limits<Index>::max();
    for (Index grain : star_)
      if (grain < first && mark(grain) == mark_around(v)) first = grain;
    find_rest(v, first);
    ends_.push_back(front_.size());
  }
  return ends_.size() > 1;
}

// The part in which the vertex lies keeps it, and with it what acts on it and who may grasp it; of several,
// as of none, the one that fills most, the first of those.
void Division::split(Index v) {
  if (was_whole(v) && !has_many_sides(v) && is_bridged(v)) return;
  if (!find_parts(v)) return;
  const Vec3d& X = grains_.point(topology_.origin(v));
  const auto part = [&](std::size_t i) {
    const std::size_t begin = i == 0 ? 0 : ends_[i - 1];
    return std::span<const Index>(front_).subspan(begin, ends_[i] - begin);
  };
  const auto has_vertex = [&](Index grain) {
    const Eigen::Vector4i& points = grains_[grain].points;
    return std::any_of(points.begin(), points.end(), [&](Index p) { return grains_.point(p) == X; });
  };
  std::size_t keeps = 0;
  std::pair<bool, double> most;
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    std::pair<bool, double> filled(std::any_of(part(i).begin(), part(i).end(), has_vertex), 0.0);
    for (Index grain : part(i)) filled.second += grains_[grain].share;
    if (i > 0 && !(most < filled)) continue;
    most = filled;
    keeps = i;
  }
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    if (i == keeps) continue;
    const Index copy = topology_.vertex_count() + static_cast<Index>(result_.vertices.size());
    result_.vertices.push_back(v);
    is_whole_.push_back(1);
    for (Index grain : part(i)) {
      Changed& known = changed(grain);
      known.has_new_corners = true;
      for (Index& corner : known.corners)
        if (corner == v) corner = copy;
    }
  }
}

// Where many faces have opened, a search for all parts is the shorter one.
bool Division::has_many_sides(Index v) const {
  constexpr int many = 12;
  int count = 0;
  for (Index side = first_side_[std::size_t(v)]; side >= 0 && count < many;
       side = sides_[std::size_t(side)].next)
    ++count;
  return count == many;
}

std::vector<Index> Division::changed_tets() const {
  std::vector<Index> tets;
  for (const Changed& known : changed_)
    if (known.has_new_corners) tets.push_back(known.element);
  sort_unique(tets);
  return tets;
}

// Grains with the same corners are one tetrahedron. What fills most keeps the number, the first of several.
void Division::divide(Index tet) {
  struct Group {
    Corners corners;
    std::vector<Index> grains;
    double share = 0;
  };
  std::vector<Group> groups;
  std::vector<Index>& all = grains_of_tet_;
  all.assign(grains_.of(tet).begin(), grains_.of(tet).end());
  std::sort(all.begin(), all.end());
  for (Index grain : all) {
    const Corners corners = corners_of(grain);
    auto at =
        std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.corners == corners; });
    if (at == groups.end()) at = groups.insert(at, Group{corners, {}, 0});
    at->grains.push_back(grain);
    at->share += grains_[grain].share;
  }
  const auto keeps = std::max_element(groups.begin(), groups.end(),
                                      [](const Group& a, const Group& b) { return a.share < b.share; });
  for (auto group = groups.begin(); group != groups.end(); ++group) {
    const Index number = group == keeps ? tet : topology_.tet_count() + new_tets_++;
    result_.parts.push_back({number, tet, group->corners, group->share});
    if (number != tet)
      for (Index grain : group->grains) changed(grain).element = number;
    (number == tet ? parts_ : new_parts_).push_back({number, std::move(group->grains)});
  }
}

// Of what was touched, of what has other corners or is new, and of what is beside these.
void Division::find_neighbours() {
  std::vector<Index> tets;
  std::vector<bool> is_listed(std::size_t(topology_.tet_count() + new_tets_), false);
  const auto list = [&](Index tet) {
    if (!is_listed[std::size_t(tet)]) tets.push_back(tet);
    is_listed[std::size_t(tet)] = true;
  };
  for (Index t : touched_) list(t);
  for (const Part& part : parts_) {
    list(part.tet);
    for (Index grain : part.grains)
      for (int f = 0; f < 4; ++f)
        if (const Index other = grains_.neighbour(grain, f); other >= 0) list(element_of(other));
  }
  std::sort(tets.begin(), tets.end());
  result_.neighbours.reserve(tets.size());
  result_.others.reserve(4 * tets.size());
  auto part = parts_.begin();
  for (Index t : tets) {
    while (part != parts_.end() && part->tet < t) ++part;
    const bool is_part = part != parts_.end() && part->tet == t;
    add_neighbours(t, is_part ? std::span<const Index>(part->grains) : grains_.of(t));
  }
}

// Two tetrahedra beside each other differ in one corner, which is opposite to the face that they share.
void Division::add_neighbours(Index tet, std::span<const Index> grains) {
  for (std::vector<Index>& others : across_) others.clear();
  others_.clear();
  const Corners corners = corners_of(grains.front());
  for (Index grain : grains) {
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(grain, f);
      if (other < 0) continue;
      const Changed* changed = find_changed(other);
      const Index element = changed ? changed->element : grains_[other].element;
      if (element == tet || std::find(others_.begin(), others_.end(), element) != others_.end()) continue;
      others_.push_back(element);
      const Corners next = changed ? changed->corners : topology_.corners(element);
      for (int c = 0; c < 4; ++c)
        if (!has(next, corners[c])) across_[std::size_t(c)].push_back(element);
    }
  }
  TetDivision::Neighbours& listed = result_.neighbours.emplace_back();
  listed.tet = tet;
  for (std::size_t f = 0; f < 4; ++f) {
    std::sort(across_[f].begin(), across_[f].end());
    listed.begin[f] = static_cast<Index>(result_.others.size());
    result_.others.insert(result_.others.end(), across_[f].begin(), across_[f].end());
  }
  listed.begin[4] = static_cast<Index>(result_.others.size());
}

}  // namespace

TetDivision Grains::divide(const Topology& topology, const std::vector<Index>& opened) {
  Division division(*this, topology, opened, parted_, scratch_, vertex_scratch_, is_whole_);
  TetDivision result = division.find();
  for (const TetDivision::Part& part : result.parts)
    while (of_element_.vertex_count() <= part.tet) of_element_.add_vertex();
  for (const auto& [grain, element] : division.moved_grains()) {
    Grain& moved = grains_[std::size_t(grain)];
    of_element_.erase_value(moved.element, grain);
    of_element_.append(element, grain);
    moved.element = element;
    changed_.push_back(grain);
  }
  parted_.clear();
  return result;
}

}  // namespace lobe
