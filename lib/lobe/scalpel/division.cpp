// Division: what hangs together around a vertex, and which of it keeps the vertex.
#include <algorithm>
#include <limits>

#include "lobe/scalpel/division.h"
#include "lobe/sort_unique.h"

namespace lobe {

Division::Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
                   const std::vector<GrainPair>& parted, Scratch scratch, std::vector<std::uint8_t>& is_whole)
    : grains_(grains),
      topology_(topology),
      parted_(parted),
      marks_(scratch.marks),
      places_(scratch.places),
      is_whole_(is_whole),
      first_side_(scratch.sides) {
  constexpr Index none = -1, seen = -2;
  marks_.resize(std::size_t(grains.count()), -1);
  places_.resize(std::size_t(grains.count()), -1);
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
  sort_unique(vertices_);
}

Division::Changed& Division::changed(Index grain) {
  Index& place = places_[std::size_t(grain)];
  if (place < 0) {
    const Index element = grains_[grain].element;
    changed_.push_back({grain, element, topology_.corners(element)});
    place = static_cast<Index>(changed_.size()) - 1;
  }
  return changed_[std::size_t(place)];
}

void Division::mark_star(Index v) {
  star_.clear();
  for (Index t : topology_.around(v)) {
    const std::span<const Index> own = grains_.of(t);
    star_.insert(star_.end(), own.begin(), own.end());
  }
  for (Index grain : star_) mark(grain) = std::max(mark(grain), is_around);
}

// Adds what hangs together with a grain in the marked star of a vertex and has not been found yet.
void Division::find_rest(Index first) {
  const std::size_t begin = front_.size();
  front_.push_back(first);
  mark(first) = is_found;
  for (std::size_t at = begin; at < front_.size() && front_.size() < star_.size(); ++at)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(front_[at], f);
      if (other < 0) continue;
      Index& of_other = mark(other);
      if (of_other != is_around) continue;
      of_other = is_found;
      front_.push_back(other);
    }
  add_connected(begin);
}

void Division::add_connected(std::size_t begin) {
  connected_.push_back(
      {*std::min_element(front_.begin() + std::ptrdiff_t(begin), front_.end()), begin, front_.size()});
}

// What hung together around a vertex comes apart only where faces opened: each part has a grain beside one.
// Finds the parts, unless the grains beside these faces still hang together. Whether they are several.
bool Division::find_parts_at_sides(Index v) {
  front_.clear();
  connected_.clear();
  const Index first = first_side_[std::size_t(v)];
  if (first < 0) return false;
  Index missing = 0;
  for (Index side = first; side >= 0; side = sides_[std::size_t(side)].next)
    missing += std::exchange(mark(sides_[std::size_t(side)].grain), is_around) != is_around;
  const auto find = [&](Index grain) {
    mark(grain) = is_found;
    front_.push_back(grain);
  };
  find(sides_[std::size_t(first)].grain);
  --missing;
  for (std::size_t at = 0; at < front_.size() && missing > 0; ++at)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(front_[at], f);
      if (other < 0 || mark(other) == is_found) continue;
      if (mark(other) == is_around)
        --missing;
      else if (!has(topology_.corners(grains_[other].element), v))
        continue;
      find(other);
    }
  const bool is_apart = missing > 0;
  if (is_apart) {
    add_connected(0);
    mark_star(v);
    for (Index side = first; side >= 0; side = sides_[std::size_t(side)].next)
      if (const Index grain = sides_[std::size_t(side)].grain; mark(grain) == is_around) find_rest(grain);
    for (Index grain : star_) mark(grain) = -1;
    std::sort(connected_.begin(), connected_.end(),
              [](const Connected& a, const Connected& b) { return a.first < b.first; });
  }
  for (Index grain : front_) mark(grain) = -1;
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
  front_.clear();
  connected_.clear();
  mark_star(v);
  while (front_.size() < star_.size()) {
    Index first = std::numeric_limits<Index>::max();
    for (Index grain : star_)
      if (grain < first && mark(grain) == is_around) first = grain;
    find_rest(first);
  }
  for (Index grain : star_) mark(grain) = -1;
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

}  // namespace lobe
