// Finds the tetrahedra that an instrument may touch, without testing all of them. Tetrahedra that are near
// each other at rest form groups of some hundred, and leaves of some ten within each group. Each of these,
// and each tetrahedron, has a box, and it is known how far vertices have moved since the box was computed.
// The box is enlarged by that distance. If it then does not meet the box of the instrument, what is in it is
// not tested. So none is missed. A shuffled or inverted mesh only costs more.
#pragma once

#include <array>
#include <vector>

#include "lobe/cut/cautery.h"

namespace lobe {

class TetGroups {
 public:
  // Call it after each step; no vertex has moved further in it than that [m]. `rounding` is the relative
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
  // A box in single precision, rounded outwards: the low corner, 0, minus the high one, 0 [m]. Two boxes
  // meet if eight numbers are at most eight others, which a processor compares at once.
  struct TetBox {
    alignas(16) std::array<float, 8> sides;
  };
  struct Leaf {
    Index begin, end;         // range in order_
    double path = -1;         // path_ when the boxes were found; −1: never
    Eigen::AlignedBox3d box;  // box of its alive tetrahedra at that time
    std::vector<Index> copies = {};
    std::vector<TetBox> boxes_of_copies = {};
  };
  struct Group {
    Index begin, end;  // range in leaves_
    double path = -1;
    Eigen::AlignedBox3d box;  // box of its leaves
  };
  template <class Real>
  struct Body {
    const Topology& topology;
    const Mat3X<double>& points;
    const Mat3X<Real>& u;
    Mat34<double> corners(Index tet) const;  // current positions of its corners [m]
  };
  void form(const Topology& topology, const Mat3X<double>& points);
  void forget_boxes(double reach);
  template <class Box>
  bool may_meet(const Box& group, const SweptVolume& volume) const;
  template <class Real>
  void find_boxes(const Body<Real>& body, Leaf& leaf);
  template <class Real>
  void search(const Body<Real>& body, const Leaf& leaf, const SweptVolume& volume,
              std::vector<Index>& meeting) const;
  static Eigen::AlignedBox3d as_double(const TetBox& box);
  static TetBox rounded(const Eigen::AlignedBox3d& box);

  std::vector<Index> order_;
  std::vector<TetBox> boxes_;   // boxes in the order of order_
  std::vector<Index> leaf_of_;  // leaf of each tetrahedron
  std::vector<Leaf> leaves_;
  std::vector<Group> groups_;
  bool is_lost_ = true;  // boxes, and the displacements when they were found, are not known
  double path_ = 0;      // no vertex has come further since these were known [m]
  double reach_ = 0;     // largest displacement then [m]
};

}  // namespace lobe
