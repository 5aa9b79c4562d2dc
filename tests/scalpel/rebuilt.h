// What blades have left of a body, found by a builder of its own; and whether a bridge is left.
#pragma once

#include <array>
#include <map>
#include <numeric>
#include <set>

#include "lobe/scalpel/grains.h"

namespace lobe::test {

class Sets {  // that are joined
 public:
  explicit Sets(Index count) : up_(std::size_t(count)) { std::iota(up_.begin(), up_.end(), 0); }
  Index of(Index i) {
    while (up_[std::size_t(i)] != i) i = up_[std::size_t(i)] = up_[std::size_t(up_[std::size_t(i)])];
    return i;
  }
  void join(Index a, Index b) { up_[std::size_t(of(a))] = of(b); }

 private:
  std::vector<Index> up_;
};

// Pieces, vertices and tetrahedra of a cut body from the grains' places and open faces alone: by joining over
// all faces, which are found by the places of their corners. Grains of tetrahedra that were removed are left
// out.
struct Rebuilt {
  Index pieces = 0, vertices = 0, tets = 0;
  Index faults = 0;                                // faces of three grains, or open on one side
  bool joined_alike = true;                        // what is joined here has one vertex in the topology
  bool same_vertices = true;                       // and what is not has several
  bool same_tets = true;                           // as the topology has them
  Index odd_edges = 0, edges_not_between_two = 0;  // triangles of the surface

  Rebuilt(const Grains& grains, const Topology& topology);
};

using Place = std::array<double, 3>;
using FacePlace = std::array<Place, 3>;

inline Rebuilt::Rebuilt(const Grains& grains, const Topology& topology) {
  const auto is_there = [&](Index g) { return topology.alive(grains[g].element); };
  const Index n = grains.count();
  const auto place = [&](Index p) {
    const Vec3d& x = grains.point(p);
    return Place{x[0], x[1], x[2]};
  };
  std::map<FacePlace, std::vector<Index>> faces;
  for (Index g = 0; g < n; ++g)
    for (int f = 0; is_there(g) && f < 4; ++f) {
      FacePlace key;
      for (int k = 0; k < 3; ++k) key[std::size_t(k)] = place(grains[g].points[face_corners[f][k]]);
      std::sort(key.begin(), key.end());
      faces[key].push_back(4 * g + f);
    }
  Sets piece(n), fragment(n), surface(4 * n);
  std::vector<std::pair<Index, Index>> links;
  std::vector<Index> outer;
  for (const auto& [key, sides] : faces) {
    faults += sides.size() > 2;
    if (sides.size() < 2) {
      outer.push_back(sides[0]);
      continue;
    }
    const Index a = sides[0] / 4, b = sides[1] / 4;
    const bool open = grains.is_open(a, sides[0] % 4);
    faults += open != grains.is_open(b, sides[1] % 4);
    if (open) {
      outer.insert(outer.end(), sides.begin(), sides.end());
      continue;
    }
    piece.join(a, b);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        if (i != sides[0] % 4 && j != sides[1] % 4 &&
            place(grains[a].points[i]) == place(grains[b].points[j]))
          surface.join(4 * a + i, 4 * b + j);
    if (topology.parent(grains[a].element) == topology.parent(grains[b].element))
      fragment.join(a, b);
    else
      links.push_back({a, b});
  }
  // A link joins the three vertices that two parents have in common.
  Sets vertex(4 * n);
  const auto parent_corner = [&](Index g, int k) {
    return topology.origin(topology.corners(grains[g].element)[k]);
  };
  for (const auto& [a, b] : links)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        if (parent_corner(a, i) == parent_corner(b, j))
          vertex.join(4 * fragment.of(a) + i, 4 * fragment.of(b) + j);
  std::set<Index> all_pieces, all_vertices;
  std::map<Index, Index> number_of;  // of the topology, per vertex here
  std::map<std::pair<Index, std::array<Index, 4>>, std::set<Index>> tets_of;
  std::set<Index> elements;
  for (Index g = 0; g < n; ++g) {
    if (!is_there(g)) continue;
    all_pieces.insert(piece.of(g));
    elements.insert(grains[g].element);
    std::array<Index, 4> corners;
    for (int k = 0; k < 4; ++k) {
      corners[std::size_t(k)] = vertex.of(4 * fragment.of(g) + k);
      const Index corner = topology.corners(grains[g].element)[k];
      joined_alike =
          joined_alike && number_of.emplace(corners[std::size_t(k)], corner).first->second == corner;
      all_vertices.insert(corners[std::size_t(k)]);
    }
    tets_of[{topology.parent(grains[g].element), corners}].insert(grains[g].element);
  }
  for (const auto& [key, own] : tets_of) same_tets = same_tets && own.size() == 1;
  std::set<Index> numbers;
  for (const auto& [own, number] : number_of) numbers.insert(number);
  same_vertices = joined_alike && numbers.size() == number_of.size();
  pieces = static_cast<Index>(all_pieces.size());
  vertices = static_cast<Index>(all_vertices.size());
  tets = static_cast<Index>(tets_of.size());
  same_tets = same_tets && tets == static_cast<Index>(elements.size());
  std::map<std::pair<Index, Index>, int> edges;
  for (Index code : outer)
    for (int k = 0; k < 3; ++k) {
      const int* c = face_corners[code % 4];
      const Index a = surface.of(4 * (code / 4) + c[k]), b = surface.of(4 * (code / 4) + c[(k + 1) % 3]);
      ++edges[std::minmax(a, b)];
    }
  for (const auto& [edge, count] : edges) {
    odd_edges += count % 2;
    edges_not_between_two += count != 2;
  }
}

// Whether grains that lie well on both sides of a surface hang together; distance(X) from it, with a sign
// [m].
template <class Distance>
bool has_bridge(const Grains& grains, Distance&& distance) {
  const double far = 0.5 * grains.mean_edge();
  std::vector<char> is_found(std::size_t(grains.count()), 0);
  for (Index first = 0; first < grains.count(); ++first) {
    if (is_found[std::size_t(first)]) continue;
    std::vector<Index> part{first};
    is_found[std::size_t(first)] = 1;
    bool above = false, below = false;
    for (std::size_t at = 0; at < part.size(); ++at) {
      double low = 1, high = -1;
      for (Index p : grains[part[at]].points) {
        const double off = distance(grains.point(p));
        low = std::min(low, off);
        high = std::max(high, off);
      }
      above = above || low > far;
      below = below || high < -far;
      for (int f = 0; f < 4; ++f)
        if (const Index other = grains.neighbour(part[at], f); other >= 0 && !is_found[std::size_t(other)]) {
          is_found[std::size_t(other)] = 1;
          part.push_back(other);
        }
    }
    if (above && below) return true;
  }
  return false;
}

}  // namespace lobe::test
