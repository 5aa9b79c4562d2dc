// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/region/viscous_kernels.h"

#include "lobe/region/compiled_terms.h"
#include "lobe/region/element_lanes.h"
#include "lobe/region/lane_sums.h"
#include "lobe/region/viscous_lanes.h"

namespace lobe::LOBE_KERNELS {
namespace {

template <Terms terms, class Real, class T = Pack<Real>>
Law<T> law_of_viscous(const PatchArrays<Real>& patch, bool guard, Index block, int first) {
  Law<T> law = patch.law.template as<T>();
  law.terms = terms;
  law.terms.guard = guard;
  if (terms.pressure && patch.pressure_blocks)
    law.pressure = ElementLanes<T>::pressure(patch.pressure_blocks[block], first, patch.pressure);
  if constexpr (terms.has_direction())
    law.direction = ElementLanes<T>::direction(patch.fibre_blocks[block], first);
  return law;
}

// The kernels are flattened (LOBE_FLATTEN): all formulas inline, however often they are used elsewhere.
template <class Real, Terms terms, bool guard>
LOBE_FLATTEN void add_viscous_forces_of(const PatchArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                                        Real* sums) {
  using T = Pack<Real>;
  using Lanes = ElementLanes<T>;
  for (Index b = 0; b < patch.block_count; ++b) {
    prefetch(patch.blocks + b);
    for (int first = 0; first < ElementBlock<Real>::width; first += Lanes::count) {
      const Law<T> law = law_of_viscous<terms>(patch, guard, b, first);
      const Lanes e(patch.blocks[b], first, patch.u);
      const Mat3<T> S = branch_stress(viscous, b, first, green_strain(e.H)) * e.V;
      const Mat3<T> VP = law_stress_beside(law.times(e.V), e.H, S);
      add_to_vertices<T>(corner_forces(VP, e.alpha), patch.blocks[b].corners, first, sums);
    }
  }
}

template <class Real, std::size_t i = 0>
void add_viscous_forces(const PatchArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                        PaddedVector<Real>* f) {
  constexpr Terms terms = viscous_terms[i];
  if constexpr (i + 1 < viscous_terms.size())
    if (!covers(terms, patch.law.terms)) return add_viscous_forces<Real, i + 1>(patch, viscous, f);
  if (patch.law.terms.guard) return add_viscous_forces_of<Real, terms, true>(patch, viscous, &f->xyz0[0]);
  add_viscous_forces_of<Real, terms, false>(patch, viscous, &f->xyz0[0]);
}

template <StiffnessPart part, class T>
Vec3<T> entries_of_block(const Mat3<T>& K) {
  if constexpr (part == StiffnessPart::diagonal) return K.diagonal();
  return {K(0, 1), K(0, 2), K(1, 2)};
}

template <class Real, StiffnessPart part>
LOBE_FLATTEN void add_viscous_stiffness_of(const PatchArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                                           Real* sums) {
  using T = Pack<Real>;
  using Lanes = ElementLanes<T>;
  for (Index b = 0; b < patch.block_count; ++b)
    for (int first = 0; first < ElementBlock<Real>::width; first += Lanes::count) {
      const Lanes e(patch.blocks[b], first, patch.u);
      const BranchesAtOnce<T> branches(viscous, b, first);
      Mat34<T> entries;
      for (int c = 0; c < 4; ++c) {
        const Mat3<T> K = branches.diagonal_block(e.H, e.gradient(c));
        entries.col(c) = entries_of_block<part, T>(K) * e.V;
      }
      add_to_vertices<T>(entries, patch.blocks[b].corners, first, sums);
    }
}

template <class Real>
void add_viscous_stiffness(const PatchArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                           StiffnessPart part, PaddedVector<Real>* K) {
  if (part == StiffnessPart::diagonal)
    return add_viscous_stiffness_of<Real, StiffnessPart::diagonal>(patch, viscous, &K->xyz0[0]);
  add_viscous_stiffness_of<Real, StiffnessPart::off_diagonal>(patch, viscous, &K->xyz0[0]);
}

}  // namespace

extern const ViscousKernels<float> viscous_single_kernels{add_viscous_forces<float>,
                                                          add_viscous_stiffness<float>};
extern const ViscousKernels<double> viscous_double_kernels{add_viscous_forces<double>,
                                                           add_viscous_stiffness<double>};

}  // namespace lobe::LOBE_KERNELS
