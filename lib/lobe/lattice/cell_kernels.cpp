// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/lattice/cell_kernels.h"

#include "lobe/fem/law.h"
#include "lobe/fem/shape.h"
#include "lobe/numerics/simd.h"

namespace lobe::LOBE_KERNELS {
namespace {

template <class T>
T row(const typename T::value_type* values) {
  return T(values);
}

// As many cells of a block as one register holds. Displacements are differences to that of the first node, so
// that a translation gives exactly no strain.
template <class T>
struct CellLanes {
  using Real = typename T::value_type;

  CellLanes(const CellBlock<Real>& block, int first, const PaddedVector<Real>* q)
      : V(row<T>(&block.volume[first])) {
    for (int n = 0; n < 8; ++n) {
      x[n] = PaddedVectors<T>::load(&q->xyz0[0], &block.nodes[n][first]);
      if (n > 0) x[n] -= x[0];
    }
    for (int n = 1; n < 8; ++n)
      for (int k = 0; k < 3; ++k) {
        gradient(k, n) = row<T>(&block.gradients[3 * (n - 1) + k][first]);
        H.col(k) += x[n] * gradient(k, n);
      }
  }

  T V;
  Vec3<T> x[8];
  Eigen::Matrix<T, 3, 8> gradient;  // of all nodes but the first
  Mat3<T> H = Mat3<T>::Constant(T(0));
};

// f_n = −V P N_n − Σ_m S_nm q_m, by differences to the first node, so that all forces together are zero.
template <class Real>
LOBE_FLATTEN void find_forces(const CellArrays<Real>& cells, PaddedVector<Real>* forces, Index begin,
                              Index end) {
  using T = Pack<Real>;
  using Block = CellBlock<Real>;
  constexpr int count = int(T::size());
  for (Index b = begin; b < end; ++b) {
    const Block& block = cells.blocks[b];
    for (int first = 0; first < Block::width; first += count) {
      const CellLanes<T> cell(block, first, cells.q);
      const Law<T> law = cells.laws[b].template as<T>();
      const Mat3<T> VP = law_stress(law.times(cell.V), cell.H);
      Vec3<T> f[8];
      for (int n = 1; n < 8; ++n) {
        f[n] = VP.col(0) * cell.gradient(0, n);
        for (int k = 1; k < 3; ++k) f[n] += VP.col(k) * cell.gradient(k, n);
      }
      for (int n = 1, entry = 0; n < 8; ++n)
        for (int m = 1; m <= n; ++m, ++entry) {
          const T S = row<T>(&block.fluctuation[entry][first]);
          f[n] += cell.x[m] * S;
          if (m < n) f[m] += cell.x[n] * S;
        }
      f[0] = f[1];
      for (int n = 2; n < 8; ++n) f[0] += f[n];
      for (int n = 0; n < 8; ++n) {
        if (n > 0) f[n] = -f[n];
        PaddedVectors<T>::store(f[n], &forces[(b * 8 + n) * Block::width + first].xyz0[0]);
      }
    }
  }
}

// An upper bound of the largest eigenvalue of a symmetric matrix: its mean eigenvalue, plus √(2/3) of the
// norm of the rest.
template <class T>
T eigenvalue_bound(const Mat3<T>& K) {
  using Real = typename T::value_type;
  const T mean = (K(0, 0) + K(1, 1) + K(2, 2)) * T(Real(1.0 / 3));
  T beside = T(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const T entry = i == j ? K(i, j) - mean : K(i, j);
      beside += entry * entry;
    }
  return mean + sqrt(beside * T(Real(2.0 / 3)));
}

template <class Real>
LOBE_FLATTEN void find_tangents(const CellArrays<Real>& cells, CellTangents<Real>* tangents, Index begin,
                                Index end) {
  using T = Pack<Real>;
  using Block = CellBlock<Real>;
  for (Index b = begin; b < end; ++b)
    for (int first = 0; first < Block::width; first += int(T::size())) {
      CellLanes<T> cell(cells.blocks[b], first, cells.q);
      cell.gradient.col(0) = -cell.gradient.col(1);
      for (int n = 2; n < 8; ++n) cell.gradient.col(0) -= cell.gradient.col(n);
      const Law<T> law = cells.laws[b].template as<T>();
      for (int n = 0; n < 8; ++n) {
        const Mat3<T> K = law_diagonal_block(law, cell.H, Vec3<T>(cell.gradient.col(n)));
        const T bound = eigenvalue_bound(K) * cell.V;
        bound.copy_to(&tangents[b].bounds[n][first]);
      }
      volume_ratio(cell.H).copy_to(&tangents[b].volume_ratio[first]);
    }
}

}  // namespace

extern const CellKernels<float> single_cell_kernels{find_forces<float>, find_tangents<float>,
                                                    int(Pack<float>::size())};
extern const CellKernels<double> double_cell_kernels{find_forces<double>, find_tangents<double>,
                                                     int(Pack<double>::size())};

}  // namespace lobe::LOBE_KERNELS
