// What grains that have come apart mean for the simulation.
#include <algorithm>
#include <map>

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
  Division(const Grains& grains, const Topology& topology) : grains_(grains), topology_(topology) {}

  TetDivision of(const std::vector<Index>& touched) {
    std::vector<Index> vertices;
    for (Index t : touched)
      for (Index v : topology_.corners(t)) vertices.push_back(v);
    sort_unique(vertices);
    for (Index v : vertices) split(v);
    for (Index t : changed_tets()) divide(t);
    find_neighbours(touched);
    return std::move(result_);
  }

  const std::map<Index, Index>& element_of() const { return element_of_; }  // of grains that have another

 private:
  Corners corners_of(Index grain) const {
    const auto at = corners_of_.find(grain);
    return at == corners_of_.end() ? topology_.corners(grains_[grain].element) : at->second;
  }
  Index element_of(Index grain) const {
    const auto at = element_of_.find(grain);
    return at == element_of_.end() ? grains_[grain].element : at->second;
  }

  std::vector<std::vector<Index>> parts_around(Index v) const;
  void split(Index v);
  std::vector<Index> changed_tets() const;
  void divide(Index tet);
  void find_neighbours(const std::vector<Index>& touched);
  TetDivision::Neighbours neighbours_of(Index tet, const std::vector<Index>& grains);

  const Grains& grains_;
  const Topology& topology_;
  std::map<Index, Corners> corners_of_;  // of grains whose tetrahedron gets other corners
  std::map<Index, Index> element_of_;
  std::map<Index, std::vector<Index>> grains_of_;  // of tetrahedra that were divided, and of their parts
  Index new_tets_ = 0;
  TetDivision result_;
};

std::vector<std::vector<Index>> Division::parts_around(Index v) const {
  std::vector<Index> left;
  for (Index t : topology_.around(v)) left.insert(left.end(), grains_.of(t).begin(), grains_.of(t).end());
  std::sort(left.begin(), left.end());
  std::vector<char> is_found(left.size(), 0);
  std::vector<std::vector<Index>> parts;
  for (std::size_t first = 0; first < left.size(); ++first) {
    if (is_found[first]) continue;
    is_found[first] = 1;
    std::vector<Index>& part = parts.emplace_back(1, left[first]);
    for (std::size_t at = 0; at < part.size(); ++at)
      for (int f = 0; f < 4; ++f) {
        const Index other = grains_.neighbour(part[at], f);
        const auto found = std::lower_bound(left.begin(), left.end(), other);
        if (other < 0 || found == left.end() || *found != other) continue;
        char& is_known = is_found[std::size_t(found - left.begin())];
        if (!is_known) part.push_back(other);
        is_known = 1;
      }
  }
  return parts;
}

// The part that fills most keeps the vertex, the first of several.
void Division::split(Index v) {
  std::vector<std::vector<Index>> parts = parts_around(v);
  if (parts.size() < 2) return;
  std::vector<double> filled(parts.size(), 0);
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (Index grain : parts[i]) filled[i] += grains_[grain].share;
  const auto keeps = std::size_t(std::max_element(filled.begin(), filled.end()) - filled.begin());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i == keeps) continue;
    const Index copy = topology_.vertex_count() + static_cast<Index>(result_.vertices.size());
    result_.vertices.push_back(v);
    for (Index grain : parts[i]) {
      Corners corners = corners_of(grain);
      for (Index& corner : corners)
        if (corner == v) corner = copy;
      corners_of_[grain] = corners;
    }
  }
}

std::vector<Index> Division::changed_tets() const {
  std::vector<Index> tets;
  for (const auto& [grain, corners] : corners_of_) tets.push_back(grains_[grain].element);
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
    const Index own = part == keeps ? tet : topology_.tet_count() + new_tets_++;
    result_.parts.push_back({own, tet, part->corners, part->share});
    for (Index grain : part->grains) element_of_[grain] = own;
    grains_of_[own] = part->grains;
  }
}

void Division::find_neighbours(const std::vector<Index>& touched) {
  const auto grains_of = [&](Index tet) {
    const auto at = grains_of_.find(tet);
    if (at != grains_of_.end()) return at->second;
    return std::vector<Index>(grains_.of(tet).begin(), grains_.of(tet).end());
  };
  std::vector<Index> tets = touched;
  for (const auto& [tet, grains] : grains_of_) tets.push_back(tet);
  sort_unique(tets);
  const std::vector<Index> inner = tets;
  for (Index t : inner)
    for (Index grain : grains_of(t))
      for (int f = 0; f < 4; ++f)
        if (const Index other = grains_.neighbour(grain, f); other >= 0) tets.push_back(element_of(other));
  sort_unique(tets);
  for (Index t : tets) result_.neighbours.push_back(neighbours_of(t, grains_of(t)));
}

// Two tetrahedra beside each other differ in one corner, which is opposite to the face that they share.
TetDivision::Neighbours Division::neighbours_of(Index tet, const std::vector<Index>& grains) {
  TetDivision::Neighbours own{tet, {}};
  const Corners corners = corners_of(grains.front());
  for (Index grain : grains)
    for (int f = 0; f < 4; ++f) {
      const Index other = grains_.neighbour(grain, f);
      if (other < 0 || element_of(other) == tet) continue;
      const Corners beside = corners_of(other);
      for (int c = 0; c < 4; ++c)
        if (!has(beside, corners[c])) own.across[std::size_t(c)].push_back(element_of(other));
    }
  for (std::vector<Index>& across : own.across) sort_unique(across);
  return own;
}

}  // namespace

TetDivision Grains::divide(const Topology& topology, const std::vector<Index>& opened) {
  Division division(*this, topology);
  TetDivision result = division.of(opened);
  for (const TetDivision::Part& part : result.parts)
    while (of_element_.vertex_count() <= part.tet) of_element_.add_vertex();
  for (const auto& [grain, element] : division.element_of()) {
    Grain& own = grains_[std::size_t(grain)];
    if (own.element == element) continue;
    of_element_.erase_value(own.element, grain);
    of_element_.append(element, grain);
    own.element = element;
    changed_.push_back(grain);
  }
  return result;
}

}  // namespace lobe
