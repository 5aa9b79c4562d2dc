// The dense products that are compiled once per instruction set (dense_kernels.cpp). They take plain arrays
// and share no inline function with the rest of the library. Otherwise the linker might keep a copy of that
// function that an older processor cannot run.
#pragma once

#include <cstddef>

#include "lobe/instruction_set.h"
#include "lobe/types.h"

namespace lobe {

// The half below the diagonal of a symmetric matrix, without the diagonal. It is stored in panels of eight
// columns. A panel has tiles of sixteen rows, from the tile in which the panel begins. A tile is stored
// column by column. Entries on the diagonal, above it or beyond the matrix are zero.
struct SymmetricHalf {
  static constexpr Index panel_columns = 8, tile_rows = 16, tile_size = panel_columns * tile_rows;
  Index size = 0;  // rows

  Index tiles() const { return (size + tile_rows - 1) / tile_rows; }
  Index panels() const { return (size + panel_columns - 1) / panel_columns; }
  Index padded() const { return tiles() * tile_rows; }
  // Tiles before a panel's first.
  Index tiles_before(Index panel) const {
    const Index m = panel / 2;
    return m * (2 * tiles() - m + 1) + panel % 2 * (tiles() - m);
  }
};

// C += sign A B, with A of rows × depth, B of depth × columns; entry (i, j) of a factor is at i × row + j ×
// column.
template <class Real>
struct MatrixFactor {
  const Real* entries;
  std::size_t row, column;
};
template <class Real>
struct MatrixProduct {
  Real sign;
  MatrixFactor<Real> A, B;
  Index rows, depth, columns;
  bool lower;  // only the lower triangle of C is computed
  Real* C;     // column by column
  std::size_t stride;
};
inline constexpr Index product_depth = 192, product_height = 256;  // blocks of a product
inline std::size_t product_scratch(Index columns) {
  return std::size_t(product_depth) * std::size_t(product_height + columns + 8);
}

template <class Real>
struct DenseKernels {
  // Adds to y what the panels [begin, end) of a symmetric matrix make of x, both filled up to whole tiles.
  void (*symmetric_product)(const Real* tiles, SymmetricHalf shape, const Real* x, Index begin, Index end,
                            Real* y);
  void (*add_product)(const MatrixProduct<Real>& product, Real* scratch);  // scratch: product_scratch()
};

template <class Real>
DenseKernels<Real> dense_kernels(InstructionSet set);  // `set`: an available one

}  // namespace lobe
