// Finds the tetrahedra that an instrument may touch, without testing all of them. Groups of some hundred
// tetrahedra that are near each other at rest remember their box and how far vertices have moved since. A
// group is tested only if its box, enlarged by that distance, meets the instrument's box. None is missed: a
// shuffled or inverted mesh only costs more.
#pragma once

#include <vector>

#include "lobe/cut/cautery.h"

namespace lobe {

class TetGroups {
 public:
  // Every vertex has moved by at most this in one more step [m]; `rounding` is that of the displacements'
  // precision.
  void moved(double distance, double rounding) { path_ += distance + rounding * (reach_ + path_); }
  // It is not known how far they have moved.
  void forget() { groups_.clear(); }

  // A copy of a tetrahedron has been added.
  void add_copy(Index tet, Index copy);
  // The tetrahedra that meet a volume, in ascending order, in the deformed body of rest positions and
  // displacements [m].
  template <class Real>
  std::vector<Index> meeting(const Topology& topology,
                             const Mat3X<double>& points,  // 3 × at least #vertices
                             const Mat3X<Real>& u,         // 3 × at least #vertices
                             const SweptVolume& volume);

 private:
  struct Group {
    Index begin, end;         // of order_
    double path = -1;         // path_ when the box was found; −1: never
    Eigen::AlignedBox3d box;  // of the alive tetrahedra
    std::vector<Index> copies = {};
  };
  void form(const Topology& topology, const Mat3X<double>& points);

  std::vector<Index> order_;
  std::vector<Index> group_of_;  // per tetrahedron; none before there is a copy
  std::vector<Group> groups_;
  double path_ = 0;   // no vertex has come further since the groups were formed [m]
  double reach_ = 0;  // largest displacement then [m]
};

}  // namespace lobe
