// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "paper/term_kernels.h"

#include "lobe/region/lane_sums.h"

namespace lobe::LOBE_KERNELS {
namespace {

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

}  // namespace

extern const TermKernels<float> single_term_kernels{add_term_forces<float>};
extern const TermKernels<double> double_term_kernels{add_term_forces<double>};

}  // namespace lobe::LOBE_KERNELS
