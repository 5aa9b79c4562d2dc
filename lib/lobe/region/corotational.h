// The corotational region: tetrahedra of the linear law in the frame of their rotations (fem/corotational.h).
// They are right where tissue turns far and is strained little. They are evaluated in patches, as non-linear
// ones are: plain ones one by one, edge-smoothed ones domain by domain.
#pragma once

#include "lobe/region/patches.h"
#include "lobe/region/smoothed_patches.h"

namespace lobe {

template <class Real>
class CorotationalRegion {
 public:
  static constexpr RegionModel model = RegionModel::corotational;

  explicit CorotationalRegion(InstructionSet set = chosen_instruction_set())
      : elements_(set), smoothed_(set) {}

  void follow(const Elements& elements, const RegionEdit& edit) {
    elements_.follow(elements, edit.left, edit.entered, model, edit.copied_tets);
    smoothed_.follow(elements, edit.left, edit.entered, model, edit.copied_tets);
  }
  void set_paces(const Paces& paces) {  // before any tetrahedra are here
    elements_.set_paces(paces);
    smoothed_.set_paces(paces);
  }
  Index tet_count() const { return elements_.tet_count(); }
  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel) {
    if (tet_count() == 0) return;
    elements_.add_forces(u, f, parallel);
    smoothed_.add_forces(u, f, parallel);
  }
  template <class Visit>  // visit(layout, sums)
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
  SmallestVolumeRatio add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K, Parallel& parallel) {
    smoothed_.add_diagonal_stiffness(u, K, parallel);
    return elements_.add_diagonal_stiffness(u, K, parallel);
  }

 private:
  Patches<Real> elements_;
  SmoothedPatches<Real> smoothed_;
};

}  // namespace lobe
