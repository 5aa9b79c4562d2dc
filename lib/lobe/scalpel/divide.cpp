// What grains that have come apart mean for the simulation.
#include <algorithm>
#include <array>
#include <map>
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
  // `places`: per grain, −1; so it is left.
  Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
           std::vector<Index>& places);
  ~Division() {
    for (const NearGrain& near : near_grains_) places_[std::size_t(near.grain)] = -1;
  }
  Division(const Division&) = delete;
  Division& operator=(const Division&) = delete;

  TetDivision find();
  // Grains, and the tetrahedra that they are part of now.
  std::vector<std::pair<Index, Index>> moved_grains() const;

 private:
  struct NearGrain {  // a grain of a tetrahedron around the vertices of those that were touched
    Index grain, element;
    Corners corners;  // of its tetrahedron, as they will be
    bool has_new_corners = false;
    Index seen_at = -1;  // the vertex around which it has not been found yet
  };

  NearGrain* near_grain(Index grain) {
    const Index place = places_[std::size_t(grain)];
    return place < 0 ? nullptr : &near_grains_[std::size_t(place)];
  }
  const NearGrain* near_grain(Index grain) const { return const_cast<Division*>(this)->near_grain(grain); }
  NearGrain& known(Index grain);
  Index element_of(Index grain) const {
    const NearGrain* known = near_grain(grain);
    return known ? known->element : grains_[grain].element;
  }
  Corners corners_of(Index grain) const {
    const NearGrain* known = near_grain(grain);
    return known ? known->corners : topology_.corners(grains_[grain].element);
  }
  std::span<const Index> grains_of(Index tet) const;

  void find_star(Index v);
  bool hangs_together(Index v);
  std::vector<std::vector<Index>> parts_around(Index v);
  void split(Index v);
  std::vector<Index> changed_tets() const;
  void divide(Index tet);
  void find_neighbours();
  TetDivision::Neighbours neighbours_of(Index tet, std::span<const Index> grains) const;

  const Grains& grains_;
  const Topology& topology_;
  std::vector<Index>& places_;  // in own_
  std::vector<Index> touched_, vertices_;
  std::vector<NearGrain> near_grains_;
  std::vector<Index> star_, front_;                // grains around a vertex; those found there
  std::map<Index, std::vector<Index>> grains_of_;  // of tetrahedra that were divided, and of their parts
  Index new_tets_ = 0;
  TetDivision result_;
};

Division::Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
                   std::vector<Index>& places)
    : grains_(grains), topology_(topology), places_(places), touched_(touched) {
  places_.resize(std::size_t(grains.count()), -1);
  for (Index t : touched)
    for (Index v : topology.corners(t)) vertices_.push_back(v);
  sort_unique(vertices_);
  near_grains_.reserve(32 * vertices_.size());
}

Division::NearGrain& Division::known(Index grain) {
  Index& place = places_[std::size_t(grain)];
  if (place < 0) {
    place = static_cast<Index>(near_grains_.size());
    const Index element = grains_[grain].element;
    near_grains_.push_back({grain, element, topology_.corners(element)});
  }
  return near_grains_[std::size_t(place)];
}

std::vector<std::pair<Index, Index>> Division::moved_grains() const {
  std::vector<std::pair<Index, Index>> moved;
  for (const NearGrain& near : near_grains_)
    if (near.element != grains_[near.grain].element) moved.emplace_back(near.grain, near.element);
  std::sort(moved.begin(), moved.end());
  return moved;
}

TetDivision Division::find() {
  for (Index v : vertices_) split(v);
  for (Index t : changed_tets()) divide(t);
  find_neighbours();
  return std::move(result_);
}

void Division::find_star(Index v) {
  star_.clear();
  for (Index t : topology_.around(v))
    for (Index grain : grains_.of(t)) {
      known(grain).seen_at = v;
      star_.push_back(grain);
    }
}

bool Division::hangs_together(Index v) {
  front_.assign(1, star_.front());
  near_grain(star_.front())->seen_at = -1;
  for (std::size_t at = 0; at < front_.size() && front_.size() < star_.size(); ++at)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(front_[at], f);
      NearGrain* next = other < 0 ? nullptr : near_grain(other);
      if (!next || next->seen_at != v) continue;
      next->seen_at = -1;
      front_.push_back(other);
    }
  return front_.size() == star_.size();
}

// In order of their first grains.
std::vector<std::vector<Index>> Division::parts_around(Index v) {
  std::sort(star_.begin(), star_.end());
  for (Index grain : star_) near_grain(grain)->seen_at = v;
  std::vector<std::vector<Index>> parts;
  for (Index first : star_) {
    NearGrain* start = near_grain(first);
    if (start->seen_at != v) continue;
    start->seen_at = -1;
    std::vector<Index>& part = parts.emplace_back(1, first);
    for (std::size_t at = 0; at < part.size(); ++at)
      for (int f = 0; f < 4; ++f) {
        const Index other = grains_.neighbour(part[at], f);
        NearGrain* next = other < 0 ? nullptr : near_grain(other);
        if (!next || next->seen_at != v) continue;
        next->seen_at = -1;
        part.push_back(other);
      }
  }
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
      NearGrain& known = *near_grain(grain);
      known.has_new_corners = true;
      for (Index& corner : known.corners)
        if (corner == v) corner = copy;
    }
  }
}

std::vector<Index> Division::changed_tets() const {
  std::vector<Index> tets;
  for (const NearGrain& known : near_grains_)
    if (known.has_new_corners) tets.push_back(known.element);
  sort_unique(tets);
  return tets;
}

// Grains with the same corners are one tetrahedron. What fills most keeps the number, the first of several.
void Division::divide(Index tet) {
  struct Part {
    Corners corners;
    std::vector<Index> grains;
    double share = 0;
  };
  std::vector<Part> parts;
  std::vector<Index> all(grains_.of(tet).begin(), grains_.of(tet).end());
  std::sort(all.begin(), all.end());
  for (Index grain : all) {
    const Corners corners = corners_of(grain);
    auto at = std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.corners == corners; });
    if (at == parts.end()) at = parts.insert(at, Part{corners, {}, 0});
    at->grains.push_back(grain);
    at->share += grains_[grain].share;
  }
  const auto keeps = std::max_element(parts.begin(), parts.end(),
                                      [](const Part& a, const Part& b) { return a.share < b.share; });
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    const Index number = part == keeps ? tet : topology_.tet_count() + new_tets_++;
    result_.parts.push_back({number, tet, part->corners, part->share});
    for (Index grain : part->grains) near_grain(grain)->element = number;
    grains_of_[number] = part->grains;
  }
}

std::span<const Index> Division::grains_of(Index tet) const {
  const auto at = grains_of_.find(tet);
  return at != grains_of_.end() ? std::span<const Index>(at->second) : grains_.of(tet);
}

// Of what was touched, of what has other corners or is new, and of what is beside these.
void Division::find_neighbours() {
  std::vector<Index> tets = touched_;
  for (const auto& [tet, grains] : grains_of_) {
    tets.push_back(tet);
    for (Index grain : grains)
      for (int f = 0; f < 4; ++f)
        if (const Index other = grains_.neighbour(grain, f); other >= 0) tets.push_back(element_of(other));
  }
  sort_unique(tets);
  result_.neighbours.reserve(tets.size());
  for (Index t : tets) result_.neighbours.push_back(neighbours_of(t, grains_of(t)));
}

// Two tetrahedra beside each other differ in one corner, which is opposite to the face that they share.
TetDivision::Neighbours Division::neighbours_of(Index tet, std::span<const Index> grains) const {
  TetDivision::Neighbours found{tet, {}};
  const Corners corners = corners_of(grains.front());
  for (Index grain : grains) {
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(grain, f);
      if (other < 0 || element_of(other) == tet) continue;
      const Corners next = corners_of(other);
      for (int c = 0; c < 4; ++c)
        if (!has(next, corners[c])) found.across[std::size_t(c)].push_back(element_of(other));
    }
  }
  for (std::vector<Index>& across : found.across)
    if (across.size() > 1) sort_unique(across);
  return found;
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
