// Finds the tetrahedra that an instrument may touch, without testing all of them. Tetrahedra that are near
// each other at rest form groups of some hundred, and leaves of some ten within each group. Each has a box,
// and stores how far vertices have moved since the box was computed. The box is enlarged by that distance. If
// it then does not meet the box of the instrument, its tetrahedra are not tested. So none is missed. A
// shuffled or inverted mesh only costs more.
#pragma once

#include <vector>

#include "lobe/cut/cautery.h"

namespace lobe {

class TetGroups {
 public:
  // Call it after each step, in which no vertex has moved further than this [m]. `rounding` is the relative
  // rounding of displacements.
  void moved(double distance, double rounding) { path_ += distance + rounding * (reach_ + path_); }
  // Call it when it is not known how far vertices have moved.
  void forget() { is_lost_ = true; }

  // Call it when a copy of a tetrahedron was added, at the same place.
  void add_copy(Index tet, Index copy);
  // The tetrahedra that meet a volume, in ascending order, in the deformed body of rest positions and
  // displacements [m].
  template <class Real>
  std::vector<Index> meeting(const Topology& topology,
                             const Mat3X<double>& points,  // 3 × at least #vertices
                             const Mat3X<Real>& u,         // 3 × at least #vertices
                             const SweptVolume& volume);

 private:
  struct Leaf {
    Index begin, end;         // of order_
    double path = -1;         // path_ when the box was found; −1: never
    Eigen::AlignedBox3d box;  // of the alive tetrahedra
    std::vector<Index> copies = {};
  };
  struct Group {
    Index begin, end;  // of leaves_
    double path = -1;
    Eigen::AlignedBox3d box;  // of its leaves
  };
  void form(const Topology& topology, const Mat3X<double>& points);
  template <class Box>
  bool may_meet(const Box& group, const SweptVolume& volume) const;

  std::vector<Index> order_;
  std::vector<Index> leaf_of_;  // per tetrahedron; none before there is a copy
  std::vector<Leaf> leaves_;
  std::vector<Group> groups_;
  bool is_lost_ = true;  // boxes, and the displacements when they were found, are not known
  double path_ = 0;      // no vertex has come further since these were known [m]
  double reach_ = 0;     // largest displacement then [m]
};

}  // namespace lobe
