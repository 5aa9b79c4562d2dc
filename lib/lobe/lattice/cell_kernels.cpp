// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/lattice/cell_kernels.h"

#include "lobe/fem/shape.h"
#include "lobe/numerics/simd.h"

namespace lobe::LOBE_KERNELS {
namespace {

template <class T>
T row(const typename T::value_type* values) {
  return T(values, std::experimental::element_aligned);
}

// f_n = −V P N_n − Σ_m S_nm q_m, by differences to the first node, so that a translation gives exactly no
// force and all forces together are zero.
template <class Real>
LOBE_FLATTEN void find_forces(const CellArrays<Real>& cells, Index begin, Index end) {
  using T = Pack<Real>;
  using Block = CellBlock<Real>;
  using Vectors = PaddedVectors<T>;
  constexpr int count = int(T::size());
  for (Index b = begin; b < end; ++b) {
    const Block& block = cells.blocks[b];
    for (int first = 0; first < Block::width; first += count) {
      Vec3<T> x[8], f[8];
      for (int n = 0; n < 8; ++n) {
        const Index* nodes = &block.nodes[n][first];
        for (int d = 0; d < 3; ++d) x[n][d] = T([&](auto lane) { return cells.q[nodes[lane]].xyz0[d]; });
        if (n > 0) x[n] -= x[0];
      }
      Mat3<T> H = Mat3<T>::Constant(T(0));
      for (int n = 1; n < 8; ++n)
        for (int k = 0; k < 3; ++k) H.col(k) += x[n] * row<T>(&block.gradients[3 * (n - 1) + k][first]);
      const Law<T> law = cells.laws[b].template as<T>();
      const Mat3<T> VP = law_stress(law.times(row<T>(&block.volume[first])), H);
      for (int n = 1; n < 8; ++n) {
        f[n] = VP.col(0) * row<T>(&block.gradients[3 * (n - 1)][first]);
        for (int k = 1; k < 3; ++k) f[n] += VP.col(k) * row<T>(&block.gradients[3 * (n - 1) + k][first]);
      }
      for (int n = 1, entry = 0; n < 8; ++n)
        for (int m = 1; m <= n; ++m, ++entry) {
          const T S = row<T>(&block.fluctuation[entry][first]);
          f[n] += x[m] * S;
          if (m < n) f[m] += x[n] * S;
        }
      f[0] = f[1];
      for (int n = 2; n < 8; ++n) f[0] += f[n];
      for (int n = 0; n < 8; ++n) {
        if (n > 0) f[n] = -f[n];
        Vectors::store(f[n], &cells.forces[(b * 8 + n) * Block::width + first].xyz0[0]);
      }
    }
  }
}

}  // namespace

extern const CellKernels<float> single_cell_kernels{find_forces<float>, int(Pack<float>::size())};
extern const CellKernels<double> double_cell_kernels{find_forces<double>, int(Pack<double>::size())};

}  // namespace lobe::LOBE_KERNELS
