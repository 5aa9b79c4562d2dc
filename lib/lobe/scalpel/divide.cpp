// What grains that have come apart mean for the simulation.
#include <algorithm>
#include <array>
#include <span>

#include "lobe/scalpel/grains.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

using Corners = Eigen::Vector4i;

bool has(const Corners& corners, Index v) { return (corners.array() == v).any(); }

// Grains of the tetrahedra around a vertex hang together there if faces lead from one to another without
// leaving these tetrahedra: a face in common ties all three vertices of its tetrahedra's face together.
class Division {
 public:
  // `marks`: per grain, −1; so it is left.
  Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
           std::vector<Index>& marks);
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

  // Of a grain: its place in changed_; −1: none; below: the vertex around which it has not been found yet.
  static Index mark_around(Index v) { return -2 - v; }
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
  std::span<const Index> grains_of(Index tet) const;

  void find_star(Index v);
  void find_rest(Index v, Index first, std::size_t most, std::vector<Index>& found);
  bool hangs_together(Index v);
  std::vector<std::vector<Index>> parts_around(Index v);
  void split(Index v);
  std::vector<Index> changed_tets() const;
  void divide(Index tet);
  void find_neighbours();
  void add_neighbours(Index tet, std::span<const Index> grains);

  const Grains& grains_;
  const Topology& topology_;
  std::vector<Index>& marks_;
  std::vector<Index> touched_, vertices_;
  std::vector<Changed> changed_;
  std::vector<Index> star_, front_;           // grains around a vertex; those found there
  std::vector<Part> parts_;                   // by their numbers, once all are found
  std::array<std::vector<Index>, 4> across_;  // scratch of add_neighbours()
  Index new_tets_ = 0;
  TetDivision result_;
};

Division::Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
                   std::vector<Index>& marks)
    : grains_(grains), topology_(topology), marks_(marks), touched_(touched) {
  marks_.resize(std::size_t(grains.count()), -1);
  for (Index t : touched)
    for (Index v : topology.corners(t)) vertices_.push_back(v);
  sort_unique(vertices_);
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
  for (Index t : changed_tets()) divide(t);
  std::sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.tet < b.tet; });
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

bool Division::hangs_together(Index v) {
  find_rest(v, star_.front(), star_.size(), front_);
  return front_.size() == star_.size();
}

// In order of their first grains.
std::vector<std::vector<Index>> Division::parts_around(Index v) {
  std::sort(star_.begin(), star_.end());
  for (Index grain : star_) mark(grain) = mark_around(v);
  std::vector<std::vector<Index>> parts;
  for (Index first : star_)
    if (mark(first) == mark_around(v)) find_rest(v, first, star_.size(), parts.emplace_back());
  return parts;
}

// The part in which the vertex lies keeps it, and with it what acts on it and who may grasp it; of several,
// as of none, the one that fills most, the first of those.
void Division::split(Index v) {
  find_star(v);
  if (hangs_together(v)) return;
  const std::vector<std::vector<Index>> parts = parts_around(v);
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
  std::vector<Index> all(grains_.of(tet).begin(), grains_.of(tet).end());
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
    parts_.push_back({number, std::move(group->grains)});
  }
}

std::span<const Index> Division::grains_of(Index tet) const {
  const auto at =
      std::lower_bound(parts_.begin(), parts_.end(), tet, [](const Part& p, Index t) { return p.tet < t; });
  return at != parts_.end() && at->tet == tet ? std::span<const Index>(at->grains) : grains_.of(tet);
}

// Of what was touched, of what has other corners or is new, and of what is beside these.
void Division::find_neighbours() {
  std::vector<Index> tets = touched_;
  for (const Part& part : parts_) {
    tets.push_back(part.tet);
    for (Index grain : part.grains)
      for (int f = 0; f < 4; ++f)
        if (const Index other = grains_.neighbour(grain, f); other >= 0) tets.push_back(element_of(other));
  }
  sort_unique(tets);
  result_.neighbours.reserve(tets.size());
  for (Index t : tets) add_neighbours(t, grains_of(t));
}

// Two tetrahedra beside each other differ in one corner, which is opposite to the face that they share.
void Division::add_neighbours(Index tet, std::span<const Index> grains) {
  for (std::vector<Index>& others : across_) others.clear();
  const Corners corners = corners_of(grains.front());
  for (Index grain : grains) {
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(grain, f);
      if (other < 0 || element_of(other) == tet) continue;
      const Corners next = corners_of(other);
      for (int c = 0; c < 4; ++c)
        if (!has(next, corners[c])) across_[std::size_t(c)].push_back(element_of(other));
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
  Division division(*this, topology, opened, scratch_);
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
  return result;
}

}  // namespace lobe
