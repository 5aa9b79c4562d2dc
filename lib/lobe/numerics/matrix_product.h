// Products of large dense matrices for the dense kernels. An entry of the result is a sum over blocks of k,
// and each block is summed in the order of k. So its bits depend neither on the width of a register nor on
// the size of a cache.
#pragma once

#include <algorithm>

#include "lobe/numerics/dense_kernels.h"
#include "lobe/numerics/simd.h"

namespace lobe::LOBE_KERNELS {
namespace {  // one for each set: included by dense_kernels.cpp alone

// Both factors are copied to panels, which the innermost loop reads from start to end. A panel has sixteen
// rows of A, or eight columns of B, filled up with zeros.
struct ProductPanels {
  static constexpr int rows = 16, columns = 8;
  static constexpr Index depth = product_depth, height = product_height;  // depth and height of a block of A

  template <int width, class Real>  // of the first factor by its rows, of the second by its columns
  static void copy(const Real* entries, std::size_t across, std::size_t along, Index count, Index length,
                   Real* panels) {
    for (Index first = 0; first < count; first += width)
      for (Index k = 0; k < length; ++k)
        for (Index i = first; i < first + width; ++i)
          *panels++ = i < count ? entries[std::size_t(i) * across + std::size_t(k) * along] : Real(0);
  }
};

// The product of a panel of A and one of B, a few registers of it at a time.
template <class Real>
void panel_product(const Real* A, const Real* B, Index depth, Real* sums) {
  using T = Pack<Real>;
  constexpr int width = static_cast<int>(T::size()), panel_rows = ProductPanels::rows;
  constexpr int packs = std::min(2, panel_rows / width), columns = width * sizeof(Real) == 64 ? 8 : 4;
  for (int i = 0; i < panel_rows; i += packs * width)
    for (int j = 0; j < ProductPanels::columns; j += columns) {
      T sum[columns * packs];
      for (T& s : sum) s = 0;
      const Real *a = A + i, *b = B + j;
      for (Index k = 0; k < depth; ++k, a += panel_rows, b += ProductPanels::columns) {
        T pack_of_a[packs];
        unrolled<packs>([&](int p) { pack_of_a[p].copy_from(a + p * width); });
        unrolled<columns>([&](int c) {
          const T factor = b[c];
          unrolled<packs>([&](int p) { sum[c * packs + p] += pack_of_a[p] * factor; });
        });
      }
      unrolled<columns * packs>(
          [&](int s) { sum[s].copy_to(sums + (j + s / packs) * panel_rows + i + s % packs * width); });
    }
}

template <class Real>
LOBE_FLATTEN void add_product(const MatrixProduct<Real>& product, Real* scratch) {
  using Panels = ProductPanels;
  const auto [sign, A, B, rows, depth, columns, lower, C, stride] = product;
  Real* const A_panels = scratch + std::size_t((columns + Panels::columns - 1) / Panels::columns) *
                                       Panels::columns * Panels::depth;
  alignas(64) Real sums[Panels::rows * Panels::columns];
  for (Index k = 0; k < depth; k += Panels::depth) {
    const Index length = std::min(Panels::depth, depth - k);
    Panels::copy<Panels::columns>(B.entries + std::size_t(k) * B.row, B.column, B.row, columns, length,
                                  scratch);
    for (Index top = 0; top < rows; top += Panels::height) {
      const Index bottom = std::min(rows, top + Panels::height);
      Panels::copy<Panels::rows>(A.entries + std::size_t(top) * A.row + std::size_t(k) * A.column, A.row,
                                 A.column, bottom - top, length, A_panels);
      for (Index j = 0; j < columns; j += Panels::columns)
        for (Index i = top; i < bottom; i += Panels::rows) {
          if (lower && i + Panels::rows <= j) continue;
          panel_product(A_panels + std::size_t(i - top) * length, scratch + std::size_t(j) * length, length,
                        sums);
          for (Index c = j; c < std::min(columns, j + Panels::columns); ++c)
            for (Index r = i; r < std::min(bottom, i + Panels::rows); ++r)
              C[std::size_t(c) * stride + r] += sign * sums[(c - j) * Panels::rows + r - i];
        }
    }
  }
}

}  // namespace
}  // namespace lobe::LOBE_KERNELS
