// The tetrahedra of a pre-computed region while it is expanded: they are non-linear for a while.
#pragma once

#include "lobe/region/nonlinear.h"

namespace lobe {

template <class Real>
class ExpandedRegion {
 public:
  static constexpr RegionModel model = RegionModel::nonlinear;

  // A region that is not `expandable` takes no tetrahedra.
  explicit ExpandedRegion(bool expandable = false) : expandable_(expandable) {}

  void set_expanded(bool is_expanded) { is_expanded_ = is_expanded; }

  void follow(const Elements& elements, const RegionEdit& edit) {
    if (expandable_) region_.follow(elements, edit, RegionModel::precomputed);
  }
  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel) {
    if (is_expanded_) region_.add_forces(u, f, parallel);
  }
  double energy(const Mat3X<Real>& u) { return is_expanded_ ? region_.energy(u) : 0; }  // [J]
  SmallestVolumeRatio add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K, Parallel& parallel) {
    return is_expanded_ ? region_.add_diagonal_stiffness(u, K, parallel) : SmallestVolumeRatio{};
  }
  template <class Visit>  // visit(layout, sums)
  void visit_patches(Visit&& visit) {
    if (is_expanded_) region_.visit_patches(visit);
  }

 private:
  bool expandable_;
  bool is_expanded_ = false;
  NonlinearRegion<Real> region_;
};

}  // namespace lobe
