// Finds the tetrahedra that a fine surface lies on.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lobe/mesh/topology.h"

namespace lobe {

// Lists of numbers, one after the other.
struct NumberLists {
  std::vector<Index> begin{0}, items;

  Index count() const { return static_cast<Index>(begin.size()) - 1; }
  std::span<const Index> operator[](Index list) const {
    return {items.data() + begin[list], std::size_t(begin[list + 1] - begin[list])};
  }
  void append(std::span<const Index> list) {
    items.insert(items.end(), list.begin(), list.end());
    begin.push_back(static_cast<Index>(items.size()));
  }
};

// For each number below `count`: the lists that have it.
NumberLists inverse(const NumberLists& lists, Index count);

// Under each triangle: the tetrahedra that are nearest to ten points spread over it, or to more, until they
// hang together by shared corners (or 325 points do not help). The points lie a little inside of it, so that
// what merely touches its rim is not among them. O(log #tets) per triangle.
NumberLists tets_under(const Mat3X<double>& points,  // 3 × n [m]
                       const Triangles& triangles, const TetMesh& mesh);

// The tetrahedron of a list that is nearest to p; the first of several. −1 if the list is empty.
Index nearest_of(std::span<const Index> tets, const TetMesh& mesh, const Vec3d& p);

enum class Touch { apart, never, together };

// How two tetrahedra that are there stand to each other: a corner that they shared at the start they share no
// more; they never shared one; they share all that they did.
Touch touch(const Topology& topology, Index tet, Index other);

enum class Bond {
  none,   // some are gone, or two do not share all corners any more that they shared at the start
  loose,  // but they do not all hang together, by corners that they share
  firm
};
Bond bond(const Topology& topology, std::span<const Index> tets);

}  // namespace lobe
