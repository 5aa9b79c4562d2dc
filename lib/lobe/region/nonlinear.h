// The non-linear region: tetrahedra with large displacements. Of edge-smoothed ones, the domains have the
// law, and each tetrahedron has the volume term and the guard.
#pragma once

#include "lobe/region/patches.h"
#include "lobe/region/smoothed_patches.h"

namespace lobe {

template <class Real>
class NonlinearRegion {
 public:
  static constexpr RegionModel model = RegionModel::nonlinear;

  explicit NonlinearRegion(InstructionSet set = chosen_instruction_set()) : elements_(set), smoothed_(set) {}

  // Takes the tetrahedra of this model.
  void follow(const Elements& elements, const RegionEdit& edit, RegionModel model = RegionModel::nonlinear) {
    elements_.follow(elements, edit.left, edit.entered, model, edit.copied_tets);
    smoothed_.follow(elements, edit.left, edit.entered, model, edit.copied_tets);
  }

  void set_paces(const Paces& paces) {  // before any tetrahedra are here
    elements_.set_paces(paces);
    smoothed_.set_paces(paces);
  }
  Index tet_count() const { return elements_.tet_count(); }

  void add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
    if (tet_count() == 0) return;
    elements_.add_forces(u, f, parallel);
    smoothed_.add_forces(u, f, parallel);
  }

  template <class Visit>  // visit(layout, sums): plain tetrahedra, then smoothed ones
  void visit_patches(Visit&& visit) {
    elements_.visit_patches(visit);
    smoothed_.visit_patches(visit);
  }

  template <class Visit>  // visit(patches), of plain and of smoothed tetrahedra with their dashpots
  void visit_viscous(Visit&& visit) {
    visit(elements_);
    visit(smoothed_);
  }
  template <class Visit>
  void visit_viscous(Visit&& visit) const {
    visit(elements_);
    visit(smoothed_);
  }
  double energy(const Mat3X<Real>& u) { return elements_.energy(u) + smoothed_.energy(u); }  // [J]

  typename Patches<Real>::Stiffness add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K,
                                                           Parallel& parallel) {
    smoothed_.add_diagonal_stiffness(u, K, parallel);
    return elements_.add_diagonal_stiffness(u, K, parallel);
  }

 private:
  Patches<Real> elements_;
  SmoothedPatches<Real> smoothed_;
};

}  // namespace lobe
