// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/region/wide_kernels.h"

#include "lobe/fem/law.h"
#include "lobe/region/compiled_terms.h"
#include "lobe/region/element_lanes.h"

namespace lobe::LOBE_KERNELS {
namespace {

// Adds lane by lane, so that the order of the sums, and so their bits, does not depend on the width.
// `numbers`: of the vertices of the lanes of each column.
template <class T, int n, class Numbers, class Real = typename T::value_type>
void add_to_vertices(const Eigen::Matrix<T, 3, n>& forces, const Numbers& numbers, int first, Real* sums) {
  using Vectors = PaddedVectors<T>;
  using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
  alignas(64) Real at_corners[n][4 * Vectors::count];
  for (int c = 0; c < n; ++c) Vectors::store(forces.col(c), at_corners[c]);
  unrolled<n * Vectors::count>([&](int i) {
    const int lane = i / n, c = i % n;
    Four sum, lane_sum;
    Real* place = sums + 4 * numbers[c][first + lane];
    std::memcpy(&sum, place, sizeof sum);
    std::memcpy(&lane_sum, at_corners[c] + Vectors::offset(lane), sizeof lane_sum);
    sum += lane_sum;
    std::memcpy(place, &sum, sizeof sum);
  });
}

// Prefetches data some blocks ahead. The prefetcher of the processor stops at every page and patch.
template <class Block>
void prefetch(const Block* block) {
  const char* bytes = reinterpret_cast<const char*>(block + 4);
  for (std::size_t line = 0; line < sizeof(Block); line += 64) __builtin_prefetch(bytes + line);
}

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
  constexpr bool any_force = !(terms == Terms{.solid = MaterialLaw::none}) || guarding == Guarding::acting;
  T smallest = 1;
  for (Index b = 0; b < patch.block_count; ++b) {
    prefetch(patch.blocks + b);
    for (int first = 0; first < ElementBlock<Real>::width; first += Lanes::count) {
      Law<T> law = law_of<terms>(patch, b, first);
      const Lanes e(patch.blocks[b], first, patch.u);
      law.terms = with_guard(terms, guarding == Guarding::acting);
      if constexpr (guarding == Guarding::asked) smallest = min(smallest, volume_ratio(e.H));
      if constexpr (!any_force) continue;
      const Mat3<T> VP = law_stress(law.times(e.V), e.H);
      add_to_vertices<T>(corner_forces(VP, e.alpha), patch.blocks[b].corners, first, sums);
    }
  }
  return hmin(smallest);
}

template <class Real, std::size_t i = 0>
Real add_forces(const PatchArrays<Real>& patch, Guarding guarding, PaddedVector<Real>* f) {
  constexpr Terms terms = compiled_terms[i];
  if constexpr (i + 1 < std::size(compiled_terms))
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

template <class Real, class Terms>
LOBE_FLATTEN void add_forces_of_terms(const TermBlocks<Real, Terms>& terms, const Real* u, Real* sums) {
  using T = Pack<Real>;
  constexpr int n = Terms::vertices;
  for (Index b = 0; b < terms.count; ++b) {
    const TermBlock<Real, Terms>& block = terms.blocks[b];
    prefetch(&block);
    for (int first = 0; first < block.width; first += int(T::size())) {
      T c[Terms::size];
      for (int k = 0; k < Terms::size; ++k) c[k].copy_from(&block.values[k][first]);
      Vec3<T> at[n], f[n];
      unrolled<n>([&](int i) { at[i] = PaddedVectors<T>::load(u, &block.vertices[i][first]); });
      if constexpr (n == 1) f[0] = vertex_force(c, at[0]);
      if constexpr (n == 2) edge_forces(c, at[0], at[1], f[0], f[1]);
      if constexpr (n == 3) triangle_forces(c, at[0], at[1], at[2], f[0], f[1], f[2]);
      if constexpr (n == 4) tet_term_forces(c, at[0], at[1], at[2], at[3], f[0], f[1], f[2], f[3]);
      Eigen::Matrix<T, 3, n> forces;
      for (int i = 0; i < n; ++i) forces.col(i) = f[i];
      add_to_vertices<T>(forces, block.vertices, first, sums);
    }
  }
}

template <class Real>
void add_term_forces(const TermArrays<Real>& patch, PaddedVector<Real>* f) {
  const Real* u = &patch.u->xyz0[0];
  Real* sums = &f->xyz0[0];
  add_forces_of_terms(patch.vertices, u, sums);
  add_forces_of_terms(patch.edges, u, sums);
  add_forces_of_terms(patch.triangles, u, sums);
  add_forces_of_terms(patch.tets, u, sums);
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
                                               add_term_forces<float>, add_edge_forces<float>};
extern const WideKernels<double> double_kernels{add_forces<double>, volume_strains<double>,
                                                add_stiffness<double>, add_term_forces<double>,
                                                add_edge_forces<double>};

}  // namespace lobe::LOBE_KERNELS
