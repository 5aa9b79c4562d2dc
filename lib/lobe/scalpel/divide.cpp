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
    Index begin, end;  // in grains_of_parts_
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
  bool find_parts_at_sides(Index v);
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
  std::vector<Index> vertices_;
  struct Side {         // a grain beside a face that opened
    Index grain, next;  // of the same vertex in sides_; negative: the last
  };
  std::vector<Side> sides_;
  std::vector<Index>& first_side_;  // per vertex, in sides_; negative: none
  std::vector<Changed> changed_;
  std::vector<Index> star_, front_;  // grains around a vertex; those found there
  struct Connected {
    Index first;             // the lowest number
    std::size_t begin, end;  // in front_
  };
  std::vector<Connected> connected_;     // parts of what is around a vertex
  std::vector<Part> parts_, new_parts_;  // by their numbers: of old tetrahedra, of new ones
  std::vector<Index> grains_of_parts_;
  struct Group {  // of grains with the same corners
    Corners corners;
    double share = 0;
  };
  std::vector<Group> groups_;                                 // scratch of divide()
  std::vector<std::pair<std::size_t, Index>> grains_of_tet_;  // the same: groups, and their grains
  std::array<std::vector<Index>, 4> across_;                  // scratch of add_neighbours()
  std::vector<Index> others_;                                 // the same
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
      first_side_(sides) {
  constexpr Index none = -1, seen = -2;
  marks_.resize(std::size_t(grains.count()), -1);
  is_whole_.resize(std::size_t(topology.vertex_count()), 0);
  first_side_.resize(std::size_t(topology.vertex_count()), none);
  for (Index t : touched)
    for (Index v : topology.corners(t))
      if (!is_whole_[std::size_t(v)] && std::exchange(first_side_[std::size_t(v)], seen) == none)
        vertices_.push_back(v);
  sides_.reserve(8 * parted.size());
  for_common_vertices([&](const GrainPair& pair, Index v) {
    Index& first = first_side_[std::size_t(v)];
    if (first == none) vertices_.push_back(v);
    for (Index grain : {pair.first, pair.second}) {
      sides_.push_back({grain, first});
      first = static_cast<Index>(sides_.size()) - 1;
    }
  });
  std::sort(vertices_.begin(), vertices_.end());
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

// What hung together around a vertex comes apart only where faces opened: each part has a grain beside one.
// Finds the parts, unless the grains beside these faces still hang together. Whether they are several.
bool Division::find_parts_at_sides(Index v) {
  front_.clear();
  connected_.clear();
  const Index first = first_side_[std::size_t(v)];
  Index missing = 0;
  for (Index side = first; side >= 0; side = sides_[std::size_t(side)].next)
    missing += std::exchange(mark(sides_[std::size_t(side)].grain), mark_around(v)) != mark_around(v);
  bool is_apart = false;
  for (Index side = first; side >= 0 && missing > 0; side = sides_[std::size_t(side)].next) {
    const Index start = sides_[std::size_t(side)].grain;
    if (mark(start) == mark_found(v)) continue;
    const std::size_t begin = front_.size();
    front_.push_back(start);
    mark(start) = mark_found(v);
    --missing;
    for (std::size_t at = begin; at < front_.size() && (missing > 0 || is_apart); ++at)
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
    is_apart = is_apart || missing > 0;
    if (is_apart)
      connected_.push_back(
          {*std::min_element(front_.begin() + std::ptrdiff_t(begin), front_.end()), begin, front_.size()});
  }
  for (Index grain : front_) mark(grain) = -1;
  std::sort(connected_.begin(), connected_.end(),
            [](const Connected& a, const Connected& b) { return a.first < b.first; });
  return is_apart;
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
  connected_.clear();
  while (front_.size() < star_.size()) {
    Index first = std::numeric_limits<Index>::max();
    for (Index grain : star_)
      if (grain < first && mark(grain) == mark_around(v)) first = grain;
    const std::size_t begin = front_.size();
    find_rest(v, first);
    connected_.push_back({first, begin, front_.size()});
  }
  return connected_.size() > 1;
}

// The part in which the vertex lies keeps it, and with it what acts on it and who may grasp it; of several,
// as of none, the one that fills most, the first of those.
void Division::split(Index v) {
  if (was_whole(v) ? !find_parts_at_sides(v) : !find_parts(v)) return;
  const Vec3d& X = grains_.point(topology_.origin(v));
  const auto part = [&](std::size_t i) {
    return std::span<const Index>(front_).subspan(connected_[i].begin,
                                                  connected_[i].end - connected_[i].begin);
  };
  const auto has_vertex = [&](Index grain) {
    const Eigen::Vector4i& points = grains_[grain].points;
    return std::any_of(points.begin(), points.end(), [&](Index p) { return grains_.point(p) == X; });
  };
  std::size_t keeps = 0;
  std::pair<bool, double> most;
  for (std::size_t i = 0; i < connected_.size(); ++i) {
    std::pair<bool, double> filled(std::any_of(part(i).begin(), part(i).end(), has_vertex), 0.0);
    for (Index grain : part(i)) filled.second += grains_[grain].share;
    if (i > 0 && !(most < filled)) continue;
    most = filled;
    keeps = i;
  }
  for (std::size_t i = 0; i < connected_.size(); ++i) {
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

std::vector<Index> Division::changed_tets() const {
  std::vector<Index> tets;
  for (const Changed& known : changed_)
    if (known.has_new_corners) tets.push_back(known.element);
  sort_unique(tets);
  return tets;
}

// Grains with the same corners are one tetrahedron. What fills most keeps the number, the first of several.
void Division::divide(Index tet) {
  groups_.clear();
  grains_of_tet_.clear();
  for (Index grain : grains_.of(tet)) grains_of_tet_.emplace_back(0, grain);
  std::sort(grains_of_tet_.begin(), grains_of_tet_.end());
  for (auto& [group, grain] : grains_of_tet_) {
    const Corners corners = corners_of(grain);
    while (group < groups_.size() && groups_[group].corners != corners) ++group;
    if (group == groups_.size()) groups_.push_back({corners, 0});
    groups_[group].share += grains_[grain].share;
  }
  const auto most = std::max_element(groups_.begin(), groups_.end(),
                                     [](const Group& a, const Group& b) { return a.share < b.share; });
  const auto keeps = std::size_t(most - groups_.begin());
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const Index number = i == keeps ? tet : topology_.tet_count() + new_tets_++;
    result_.parts.push_back({number, tet, groups_[i].corners, groups_[i].share});
    const auto begin = static_cast<Index>(grains_of_parts_.size());
    for (const auto& [group, grain] : grains_of_tet_) {
      if (group != i) continue;
      grains_of_parts_.push_back(grain);
      if (number != tet) changed(grain).element = number;
    }
    (number == tet ? parts_ : new_parts_)
        .push_back({number, begin, static_cast<Index>(grains_of_parts_.size())});
  }
}

// Of what a face has opened between, of what has other corners or is new, and of what is beside these.
void Division::find_neighbours() {
  const auto grains_of = [this](const Part& part) {
    return std::span<const Index>(grains_of_parts_)
        .subspan(std::size_t(part.begin), std::size_t(part.end - part.begin));
  };
  std::vector<Index> tets;
  std::vector<bool> is_listed(std::size_t(topology_.tet_count() + new_tets_), false);
  const auto list = [&](Index tet) {
    if (!is_listed[std::size_t(tet)]) tets.push_back(tet);
    is_listed[std::size_t(tet)] = true;
  };
  for (const auto& [a, b] : parted_) {
    if (grains_[a].element == grains_[b].element) continue;
    for (Index grain : {a, b}) list(grains_[grain].element);
  }
  for (const Part& part : parts_) {
    list(part.tet);
    for (Index grain : grains_of(part))
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
    add_neighbours(t, is_part ? grains_of(*part) : grains_.of(t));
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
