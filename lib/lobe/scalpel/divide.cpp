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
  Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
           const std::vector<GrainPair>& parted, std::vector<Index>& marks,
           std::vector<std::uint8_t>& is_whole);
  ~Division() {
    for (const Changed& changed : changed_) marks_[std::size_t(changed.grain)] = -1;
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
  void find_rest(Index v, Index first, std::size_t most, std::vector<Index>& found);
  bool is_bridged(Index v);
  bool was_whole(Index v);
  bool may_part() const;
  std::vector<std::vector<Index>> parts_around(Index v);
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
  std::vector<std::pair<Index, Index>> sides_;  // vertices, and grains beside faces that opened there; sorted
  std::vector<Changed> changed_;
  std::vector<Index> star_, front_;           // grains around a vertex; those found there
  std::vector<Part> parts_, new_parts_;       // by their numbers: of old tetrahedra, of new ones
  std::vector<Index> grains_of_tet_;          // scratch of divide()
  std::array<std::vector<Index>, 4> across_;  // scratch of add_neighbours()
  Index new_tets_ = 0;
  TetDivision result_;
};

Division::Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
                   const std::vector<GrainPair>& parted, std::vector<Index>& marks,
                   std::vector<std::uint8_t>& is_whole)
    : grains_(grains),
      topology_(topology),
      parted_(parted),
      marks_(marks),
      is_whole_(is_whole),
      touched_(touched) {
  marks_.resize(std::size_t(grains.count()), -1);
  is_whole_.resize(std::size_t(topology.vertex_count()), 0);
  for (Index t : touched)
    for (Index v : topology.corners(t)) vertices_.push_back(v);
  sort_unique(vertices_);
  sides_.reserve(8 * parted.size());
  for_common_vertices([&](const GrainPair& pair, Index v) {
    sides_.emplace_back(v, pair.first);
    sides_.emplace_back(v, pair.second);
  });
  sort_unique(sides_);
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

// What hangs together with a grain around a vertex and has not been found yet; no more than `most`.
void Division::find_rest(Index v, Index first, std::size_t most, std::vector<Index>& found) {
  found.assign(1, first);
  mark(first) = -1;
  for (std::size_t at = 0; at < found.size() && found.size() < most; ++at)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(found[at], f);
      if (other < 0) continue;
      Index& of_other = mark(other);
      if (of_other != mark_around(v)) continue;
      of_other = -1;
      found.push_back(other);
    }
}

// Whether grains that have been parted around a vertex still hang together there, around what has opened.
// What hung together before still does, then.
bool Division::is_bridged(Index v) {
  const auto begin = std::lower_bound(sides_.begin(), sides_.end(), std::pair(v, Index(0)));
  const auto end = std::find_if(begin, sides_.end(), [&](const auto& side) { return side.first != v; });
  if (begin == end) return true;
  for (auto side = begin; side != end; ++side) mark(side->second) = mark_around(v);
  front_.assign(1, begin->second);
  mark(begin->second) = mark_found(v);
  auto missing = end - begin - 1;
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
  for (auto side = begin; side != end; ++side) mark(side->second) = -1;
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

// What hangs together around a vertex, in order of the first grains.
std::vector<std::vector<Index>> Division::parts_around(Index v) {
  find_star(v);
  std::vector<std::vector<Index>> parts;
  for (std::size_t found = 0; found < star_.size(); found += parts.back().size()) {
    Index first = std::numeric_limits<Index>::max();
    for (Index grain : star_)
      if (grain < first && mark(grain) == mark_around(v)) first = grain;
    find_rest(v, first, star_.size() - found, parts.emplace_back());
  }
  return parts;
}

// The part in which the vertex lies keeps it, and with it what acts on it and who may grasp it; of several,
// as of none, the one that fills most, the first of those.
void Division::split(Index v) {
  if (was_whole(v) && is_bridged(v)) return;
  const std::vector<std::vector<Index>> parts = parts_around(v);
  if (parts.size() < 2) return;
  const Vec3d& X = grains_.point(topology_.origin(v));
  const auto has_vertex = [&](Index grain) {
    const Eigen::Vector4i& points = grains_[grain].points;
    return std::any_of(points.begin(), points.end(), [&](Index p) { return grains_.point(p) == X; });
  };
  std::vector<std::pair<bool, double>> filled(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    filled[i].first = std::any_of(parts[i].begin(), parts[i].end(), has_vertex);
    for (Index grain : parts[i]) filled[i].second += grains_[grain].share;
  }
  const auto keeps = std::size_t(std::max_element(filled.begin(), filled.end()) - filled.begin());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i == keeps) continue;
    const Index copy = topology_.vertex_count() + static_cast<Index>(result_.vertices.size());
    result_.vertices.push_back(v);
    is_whole_.push_back(1);
    for (Index grain : parts[i]) {
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
  std::vector<Index> tets = touched_;
  for (const Part& part : parts_) {
    tets.push_back(part.tet);
    for (Index grain : part.grains)
      for (int f = 0; f < 4; ++f)
        if (const Index other = grains_.neighbour(grain, f); other >= 0)
          if (const Index tet = element_of(other); tet != tets.back()) tets.push_back(tet);
  }
  sort_unique(tets);
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
  const Corners corners = corners_of(grains.front());
  for (Index grain : grains) {
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(grain, f);
      if (other < 0) continue;
      const Changed* changed = find_changed(other);
      const Index element = changed ? changed->element : grains_[other].element;
      if (element == tet) continue;
      const Corners next = changed ? changed->corners : topology_.corners(element);
      for (int c = 0; c < 4; ++c)
        if (!has(next, corners[c])) across_[std::size_t(c)].push_back(element);
    }
  }
  TetDivision::Neighbours& listed = result_.neighbours.emplace_back();
  listed.tet = tet;
  for (std::size_t f = 0; f < 4; ++f) {
    if (across_[f].size() > 1) sort_unique(across_[f]);
    listed.begin[f] = static_cast<Index>(result_.others.size());
    result_.others.insert(result_.others.end(), across_[f].begin(), across_[f].end());
  }
  listed.begin[4] = static_cast<Index>(result_.others.size());
}

}  // namespace

TetDivision Grains::divide(const Topology& topology, const std::vector<Index>& opened) {
  Division division(*this, topology, opened, parted_, scratch_, is_whole_);
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
