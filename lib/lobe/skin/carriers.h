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

// Returns for each number below `count` the lists that have it.
NumberLists inverse(const NumberLists& lists, Index count);

// Returns the tetrahedra under each triangle: those that are nearest to ten points spread over it. If these
// are not connected by shared corners, it takes more points, up to 325. The points lie a little inside the
// triangle, so that tetrahedra that only touch its rim are not among them. O(log #tets) per triangle.
NumberLists tets_under(const Mat3X<double>& points,  // 3 × n [m]
                       const Triangles& triangles, const TetMesh& mesh);

// Returns the tetrahedron of a list that is nearest to p; the first of several. −1 if the list is empty.
Index nearest_of(std::span<const Index> tets, const TetMesh& mesh, const Vec3d& p);

enum class Touch { apart, never, together };

// Whether two tetrahedra that exist still touch. apart: they no longer share a corner that they shared at the
// start. never: they never shared a corner. together: they share all corners that they shared at the start.
Touch touch(const Topology& topology, Index tet, Index other);

enum class Bond {
  none,   // some tetrahedra are gone, or two do not share all corners any more that they shared at the start
  loose,  // not all are connected by corners that they share
  firm
};
Bond bond(const Topology& topology, std::span<const Index> tets);

}  // namespace lobe
