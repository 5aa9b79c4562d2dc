// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/region/wide_kernels.h"

#include "lobe/fem/law.h"
#include "lobe/region/compiled_terms.h"
#include "lobe/region/element_lanes.h"
#include "lobe/region/lane_sums.h"

namespace lobe::LOBE_KERNELS {
namespace {

// The law of each lane at the pressure of its nodes, with its fibre.
template <Terms terms, class Real, class T = Pack<Real>>
Law<T> law_of(const PatchArrays<Real>& patch, Index block, int first) {
  Law<T> law = patch.law.template as<T>();
  law.terms.pressure = terms.pressure;
  if constexpr (terms.pressure)
    law.pressure = ElementLanes<T>::pressure(patch.pressure_blocks[block], first, patch.pressure);
  if constexpr (terms.has_direction())
    law.direction = ElementLanes<T>::direction(patch.fibre_blocks[block], first);
  return law;
}

constexpr Terms with_guard(Terms terms, bool guard) {
  terms.guard = guard;
  return terms;
}

// The kernels are flattened (LOBE_FLATTEN): all formulas inline, however often they are used elsewhere.
template <class Real, Terms terms, Guarding guarding>
LOBE_FLATTEN Real add_forces_of(const PatchArrays<Real>& patch, Real* sums) {
  using T = Pack<Real>;
  using Lanes = ElementLanes<T>;
  T smallest = 1;
  for (Index b = 0; b < patch.block_count; ++b) {
    prefetch(patch.blocks + b);
    for (int first = 0; first < ElementBlock<Real>::width; first += Lanes::count) {
      Law<T> law = law_of<terms>(patch, b, first);
      const Lanes e(patch.blocks[b], first, patch.u);
      law.terms = with_guard(terms, guarding == Guarding::acting);
      if constexpr (guarding == Guarding::asked) smallest = min(smallest, volume_ratio(e.H));
      const Mat3<T> VP = law_stress(law.times(e.V), e.H);
      add_to_vertices<T>(corner_forces(VP, e.alpha), patch.blocks[b].corners, first, sums);
    }
  }
  return hmin(smallest);
}

template <class Real, std::size_t i = 0>
Real add_forces(const PatchArrays<Real>& patch, Guarding guarding, PaddedVector<Real>* f) {
  constexpr Terms terms = compiled_terms[i];
  if constexpr (i + 1 < compiled_terms.size())
    if (!covers(terms, patch.law.terms)) return add_forces<Real, i + 1>(patch, guarding, f);
  Real* sums = &f->xyz0[0];
  if (guarding == Guarding::off) return add_forces_of<Real, terms, Guarding::off>(patch, sums);
  if (guarding == Guarding::asked) return add_forces_of<Real, terms, Guarding::asked>(patch, sums);
  return add_forces_of<Real, terms, Guarding::acting>(patch, sums);
}

template <class Real, MaterialLaw law>
LOBE_FLATTEN void volume_strains_of(const PatchArrays<Real>& patch, Real* rows) {
  using Lanes = ElementLanes<Pack<Real>>;
  constexpr int width = ElementBlock<Real>::width;
  for (Index b = 0; b < patch.block_count; ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(patch.blocks[b], first, patch.u);
      const Pack<Real> strain = e.V * pressure_strain(e.H, law);
      strain.copy_to(rows + b * width + first);
    }
}

template <class Real>
void volume_strains(const PatchArrays<Real>& patch, Real* rows) {
  if (averages_green_strain(patch.law.terms.solid))
    return volume_strains_of<Real, MaterialLaw::svk>(patch, rows);
  volume_strains_of<Real, MaterialLaw::neo_hookean>(patch, rows);
}

template <StiffnessPart part, class T>
Vec3<T> entries_of(const Mat3<T>& K) {
  if constexpr (part == StiffnessPart::diagonal) return K.diagonal();
  return {K(0, 1), K(0, 2), K(1, 2)};
}

// `solid`: the terms that every tetrahedron of the patch has, without question.
template <class Real, StiffnessPart part, Terms solid>
LOBE_FLATTEN Real add_stiffness_of(const PatchArrays<Real>& patch, Real* sums) {
  using T = Pack<Real>;
  using Lanes = ElementLanes<T>;
  T smallest = 1;
  for (Index b = 0; b < patch.block_count; ++b)
    for (int first = 0; first < ElementBlock<Real>::width; first += Lanes::count) {
      const Lanes e(patch.blocks[b], first, patch.u);
      const T ratio = T(1) + volume_change(e.H);
      smallest = min(ratio, smallest);
      Law<T> law = law_of<solid>(patch, b, first);
      law.terms = solid;
      law.terms.volume = patch.law.terms.volume;
      law.terms.guard = patch.law.terms.guard && any_of(ratio < law.guard_threshold);
      Mat34<T> entries;
      for (int c = 0; c < 4; ++c) {
        const Mat3<T> K = law_diagonal_block(law, e.H, e.gradient(c));
        entries.col(c) = entries_of<part, T>(K) * e.V;
      }
      add_to_vertices<T>(entries, patch.blocks[b].corners, first, sums);
    }
  return hmin(smallest);
}

// Of laws other than St Venant-Kirchhoff, whose fibres are their own, and to which a pressure adds nothing.
template <class Real, StiffnessPart part, int law = 1 + int(MaterialLaw::svk)>
Real add_stiffness_of_other(const PatchArrays<Real>& patch, Real* sums) {
  if constexpr (law + 1 < solid_count)
    if (patch.law.terms.solid != MaterialLaw(law))
      return add_stiffness_of_other<Real, part, law + 1>(patch, sums);
  return add_stiffness_of<Real, part, Terms{.solid = MaterialLaw(law)}>(patch, sums);
}

template <class Real, StiffnessPart part, bool nodal_pressure>
Real add_stiffness_part(const PatchArrays<Real>& patch, Real* sums) {
  const Terms& terms = patch.law.terms;
  if (terms.solid != MaterialLaw::svk && terms.solid != MaterialLaw::none)
    return add_stiffness_of_other<Real, part>(patch, sums);
  if (terms.fibre)
    return add_stiffness_of<Real, part, Terms{.pressure = nodal_pressure, .fibre = true}>(patch, sums);
  return add_stiffness_of<Real, part, Terms{.pressure = nodal_pressure}>(patch, sums);
}

template <class Real>
Real add_stiffness(const PatchArrays<Real>& patch, StiffnessPart part, PaddedVector<Real>* K) {
  Real* sums = &K->xyz0[0];
  if (part == StiffnessPart::off_diagonal)  // a pressure adds to the diagonal
    return add_stiffness_part<Real, StiffnessPart::off_diagonal, false>(patch, sums);
  return patch.pressure_blocks ? add_stiffness_part<Real, StiffnessPart::diagonal, true>(patch, sums)
                               : add_stiffness_part<Real, StiffnessPart::diagonal, false>(patch, sums);
}

// f_i = −K_ij d, f_j = K_ijᵀ d with d = u_j − u_i.
template <class Real>
LOBE_FLATTEN void add_edge_forces(const EdgeBlock<Real>* blocks, Index count, const PaddedVector<Real>* u,
                                  PaddedVector<Real>* f) {
  using T = Pack<Real>;
  for (Index b = 0; b < count; ++b) {
    prefetch(blocks + b);
    for (int first = 0; first < EdgeBlock<Real>::width; first += static_cast<int>(T::size())) {
      const auto& corners = blocks[b].corners;
      const Vec3<T> d = PaddedVectors<T>::load(&u->xyz0[0], &corners[1][first]) -
                        PaddedVectors<T>::load(&u->xyz0[0], &corners[0][first]);
      Mat3<T> K;
      for (int i = 0; i < 9; ++i) K(i % 3, i / 3).copy_from(&blocks[b].K[i][first]);
      Eigen::Matrix<T, 3, 2> forces;
      forces.col(0) = -K.lazyProduct(d);
      forces.col(1) = K.transpose().lazyProduct(d);
      add_to_vertices<T>(forces, corners, first, &f->xyz0[0]);
    }
  }
}

}  // namespace

extern const WideKernels<float> single_kernels{add_forces<float>, volume_strains<float>, add_stiffness<float>,
                                               add_edge_forces<float>};
extern const WideKernels<double> double_kernels{add_forces<double>, volume_strains<double>,
                                                add_stiffness<double>, add_edge_forces<double>};

}  // namespace lobe::LOBE_KERNELS
