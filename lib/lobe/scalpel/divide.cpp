// What grains that have come apart mean for the simulation.
#include <algorithm>
#include <array>
#include <map>

#include "lobe/scalpel/grains.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

using Corners = Eigen::Vector4i;

bool has(const Corners& corners, Index v) { return (corners.array() == v).any(); }

struct FaceOfGrain {
  std::array<Index, 3> points;  // ascending
  Index code;                   // 4 × place of the grain + face
  bool operator<(const FaceOfGrain& other) const { return points < other.points; }
};

// Grains of the tetrahedra around a vertex hang together there if faces lead from one to another without
// leaving these tetrahedra: a face in common ties all three vertices of its tetrahedra's face together.
class Division {
 public:
  Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched);

  TetDivision find();
  template <class Visit>
  void for_moved_grains(Visit&& visit) const {  // visit(grain, the tetrahedron that it is part of now)
    for (const Own& own : own_)
      if (own.element != grains_[own.grain].element) visit(own.grain, own.element);
  }

 private:
  static constexpr Index unknown = -2;
  struct Own {  // a grain of a tetrahedron around the vertices of those that were touched
    Index grain, element;
    Corners corners;  // of its tetrahedron, as they will be
    bool has_new_corners = false;
    std::array<Index, 4> beside{unknown, unknown, unknown, unknown};  // grains
    Index seen_at = -1;  // the vertex around which it has not been found yet
  };

  Own* own(Index grain);
  const Own* own(Index grain) const { return const_cast<Division*>(this)->own(grain); }
  Index beside(const Own& own, int face) const {
    const Index known = own.beside[std::size_t(face)];
    return known == unknown ? grains_.neighbour(own.grain, face) : known;
  }
  Index element_of(Index grain) const {
    const Own* known = own(grain);
    return known ? known->element : grains_[grain].element;
  }
  Corners corners_of(Index grain) const {
    const Own* known = own(grain);
    return known ? known->corners : topology_.corners(grains_[grain].element);
  }
  std::vector<Index> grains_of(Index tet) const;

  void find_beside();
  std::vector<std::vector<Index>> parts_around(Index v);
  void split(Index v);
  std::vector<Index> changed_tets() const;
  void divide(Index tet);
  void find_neighbours();
  TetDivision::Neighbours neighbours_of(Index tet, const std::vector<Index>& grains) const;

  const Grains& grains_;
  const Topology& topology_;
  std::vector<Index> touched_, vertices_;
  std::vector<Own> own_;                           // by their grains
  std::map<Index, std::vector<Index>> grains_of_;  // of tetrahedra that were divided, and of their parts
  Index new_tets_ = 0;
  TetDivision result_;
};

Division::Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched)
    : grains_(grains), topology_(topology), touched_(touched) {
  for (Index t : touched)
    for (Index v : topology.corners(t)) vertices_.push_back(v);
  sort_unique(vertices_);
  std::vector<Index> tets, all;
  for (Index v : vertices_) tets.insert(tets.end(), topology.around(v).begin(), topology.around(v).end());
  sort_unique(tets);
  for (Index t : tets) all.insert(all.end(), grains.of(t).begin(), grains.of(t).end());
  std::sort(all.begin(), all.end());
  own_.reserve(all.size());
  for (Index grain : all) {
    const Index element = grains[grain].element;
    own_.push_back({grain, element, topology.corners(element)});
  }
  find_beside();
}

// Who shares a face with whom, of all these at once; of faces on the rim it is found when it is asked for.
void Division::find_beside() {
  std::vector<FaceOfGrain> faces;
  faces.reserve(4 * own_.size());
  for (std::size_t i = 0; i < own_.size(); ++i)
    for (int f = 0; f < 4; ++f) {
      if (grains_.is_open(own_[i].grain, f) || grains_.is_skin(own_[i].grain, f)) {
        own_[i].beside[std::size_t(f)] = -1;
        continue;
      }
      const int* c = face_corners[f];
      const Eigen::Vector4i& p = grains_[own_[i].grain].points;
      FaceOfGrain face{{p[c[0]], p[c[1]], p[c[2]]}, 4 * static_cast<Index>(i) + f};
      std::sort(face.points.begin(), face.points.end());
      faces.push_back(face);
    }
  std::sort(faces.begin(), faces.end());
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].points != faces[i + 1].points) continue;
    Own &a = own_[std::size_t(faces[i].code / 4)], &b = own_[std::size_t(faces[i + 1].code / 4)];
    a.beside[std::size_t(faces[i].code % 4)] = b.grain;
    b.beside[std::size_t(faces[i + 1].code % 4)] = a.grain;
  }
}

Division::Own* Division::own(Index grain) {
  const auto at = std::lower_bound(own_.begin(), own_.end(), grain,
                                   [](const Own& known, Index g) { return known.grain < g; });
  return at != own_.end() && at->grain == grain ? &*at : nullptr;
}

TetDivision Division::find() {
  for (Index v : vertices_) split(v);
  for (Index t : changed_tets()) divide(t);
  find_neighbours();
  return std::move(result_);
}

std::vector<std::vector<Index>> Division::parts_around(Index v) {
  std::vector<Index> left;
  for (Index t : topology_.around(v)) left.insert(left.end(), grains_.of(t).begin(), grains_.of(t).end());
  std::sort(left.begin(), left.end());
  for (Index grain : left) own(grain)->seen_at = v;
  std::vector<std::vector<Index>> parts;
  for (Index first : left) {
    Own* start = own(first);
    if (start->seen_at != v) continue;
    start->seen_at = -1;
    std::vector<Index>& part = parts.emplace_back(1, first);
    for (std::size_t at = 0; at < part.size(); ++at)
      for (const Index other : own(part[at])->beside) {
        Own* next = other < 0 ? nullptr : own(other);
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
  std::vector<std::vector<Index>> parts = parts_around(v);
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
    for (Index grain : parts[i]) {
      Own& known = *own(grain);
      known.has_new_corners = true;
      for (Index& corner : known.corners)
        if (corner == v) corner = copy;
    }
  }
}

std::vector<Index> Division::changed_tets() const {
  std::vector<Index> tets;
  for (const Own& known : own_)
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
    for (Index grain : part->grains) own(grain)->element = number;
    grains_of_[number] = part->grains;
  }
}

std::vector<Index> Division::grains_of(Index tet) const {
  const auto at = grains_of_.find(tet);
  if (at != grains_of_.end()) return at->second;
  return {grains_.of(tet).begin(), grains_.of(tet).end()};
}

void Division::find_neighbours() {
  std::vector<Index> tets = touched_;
  for (const auto& [tet, grains] : grains_of_) tets.push_back(tet);
  sort_unique(tets);
  const std::vector<Index> inner = tets;
  for (Index t : inner)
    for (Index grain : grains_of(t))
      for (int f = 0; f < 4; ++f)
        if (const Index other = beside(*own(grain), f); other >= 0) tets.push_back(element_of(other));
  sort_unique(tets);
  for (Index t : tets) result_.neighbours.push_back(neighbours_of(t, grains_of(t)));
}

// Two tetrahedra beside each other differ in one corner, which is opposite to the face that they share.
TetDivision::Neighbours Division::neighbours_of(Index tet, const std::vector<Index>& grains) const {
  TetDivision::Neighbours found{tet, {}};
  const Corners corners = corners_of(grains.front());
  for (Index grain : grains) {
    const Own* known = own(grain);
    for (int f = 0; f < 4; ++f) {
      const Index other = known ? beside(*known, f) : grains_.neighbour(grain, f);
      if (other < 0 || element_of(other) == tet) continue;
      const Corners next = corners_of(other);
      for (int c = 0; c < 4; ++c)
        if (!has(next, corners[c])) found.across[std::size_t(c)].push_back(element_of(other));
    }
  }
  for (std::vector<Index>& across : found.across) sort_unique(across);
  return found;
}

}  // namespace

TetDivision Grains::divide(const Topology& topology, const std::vector<Index>& opened) {
  Division division(*this, topology, opened);
  TetDivision result = division.find();
  for (const TetDivision::Part& part : result.parts)
    while (of_element_.vertex_count() <= part.tet) of_element_.add_vertex();
  std::vector<std::pair<Index, Index>> moved;
  division.for_moved_grains([&](Index grain, Index element) { moved.emplace_back(grain, element); });
  for (const auto& [grain, element] : moved) {
    Grain& own = grains_[std::size_t(grain)];
    of_element_.erase_value(own.element, grain);
    of_element_.append(element, grain);
    own.element = element;
    changed_.push_back(grain);
  }
  return result;
}

}  // namespace lobe
