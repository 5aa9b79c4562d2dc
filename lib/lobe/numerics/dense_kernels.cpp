// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/numerics/dense_kernels.h"

#include <cstring>

#include "lobe/numerics/matrix_product.h"

namespace lobe::LOBE_KERNELS {
namespace {

// The sums over the sixteen lanes of each of four columns, always in the same order.
template <class Real>
void add_column_sums(const Real* lanes, Real* sums) {
  using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
  Four f[4];
  unrolled<4>([&](int c) {
    Four quarter[4];
    std::memcpy(quarter, lanes + 16 * c, sizeof quarter);
    f[c] = (quarter[0] + quarter[1]) + (quarter[2] + quarter[3]);
  });
  const Four xy = __builtin_shufflevector(f[0], f[1], 0, 4, 1, 5),
             zw = __builtin_shufflevector(f[0], f[1], 2, 6, 3, 7),
             next_xy = __builtin_shufflevector(f[2], f[3], 0, 4, 1, 5),
             next_zw = __builtin_shufflevector(f[2], f[3], 2, 6, 3, 7);
  Four sum;
  std::memcpy(&sum, sums, sizeof sum);
  sum +=
      (__builtin_shufflevector(xy, next_xy, 0, 1, 4, 5) + __builtin_shufflevector(xy, next_xy, 2, 3, 6, 7)) +
      (__builtin_shufflevector(zw, next_zw, 0, 1, 4, 5) + __builtin_shufflevector(zw, next_zw, 2, 3, 6, 7));
  std::memcpy(sums, &sum, sizeof sum);
}

// Each entry is read once and used twice, as S_ij and as S_ji; the sums of a panel's columns stay in
// registers.
template <class Real>
LOBE_FLATTEN void symmetric_product(const Real* tiles, SymmetricHalf shape, const Real* x, Index begin,
                                    Index end, Real* y) {
  using T = Pack<Real>;
  constexpr int columns = SymmetricHalf::panel_columns, rows = SymmetricHalf::tile_rows;
  const Index tile_count = shape.tiles();
  for (Index p = begin; p < end; ++p) {
    const Index first = p * columns / rows;
    const Real* panel = tiles + std::size_t(shape.tiles_before(p)) * SymmetricHalf::tile_size;
    alignas(64) Real lanes[columns * rows];
    for (int k = 0; k < rows; k += static_cast<int>(T::size())) {
      T sums[columns], x_of[columns];
      unrolled<columns>([&](int c) {
        sums[c] = 0;
        x_of[c] = x[p * columns + c];
      });
      const Real* tile = panel + k;
      for (Index t = first; t < tile_count; ++t, tile += SymmetricHalf::tile_size) {
        const T pack_of_x(x + t * rows + k);
        T even = 0, odd = 0;
        unrolled<columns>([&](int c) {
          const T S(tile + c * rows);
          (c % 2 == 0 ? even : odd) += S * x_of[c];
          sums[c] += S * pack_of_x;
        });
        T sum(y + t * rows + k);
        sum += even + odd;
        sum.copy_to(y + t * rows + k);
      }
      unrolled<columns>([&](int c) { sums[c].copy_to(lanes + c * rows + k); });
    }
    add_column_sums(lanes, y + p * columns);
    add_column_sums(lanes + columns * rows / 2, y + p * columns + 4);
  }
}

}  // namespace

extern const DenseKernels<float> single_dense_kernels{symmetric_product<float>, add_product<float>};
extern const DenseKernels<double> double_dense_kernels{symmetric_product<double>, add_product<double>};

}  // namespace lobe::LOBE_KERNELS
