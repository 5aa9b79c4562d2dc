// The loops that every instruction set has a copy of its own of: wide_kernels.cpp is compiled once per set. They
// take plain arrays and share no inline function with the rest of the library, of which the linker might else
// keep the copy that an older processor cannot run.
#pragma once

#include "lobe/instruction_set.h"
#include "lobe/region/element_block.h"
#include "lobe/region/term_block.h"

namespace lobe {

enum class ElementPart { svk, volume_term, both };
// By fem/guard.h; asked: not, but the smallest det F is looked for.
enum class Guarding { off, asked, acting };

enum class StiffnessPart { diagonal, beside };  // xx, yy, zz; xy, xz, yz

template <class Real>
struct PatchArrays {  // one patch: all its tetrahedra are of one material
  const ElementBlock<Real>* blocks;
  Index block_count;
  const PressureBlock<Real>* pressure_blocks;  // null without nodal pressure
  const Real* pressure;                        // per node [Pa]
  const PaddedVector<Real>* u;                 // per vertex of the patch [m]
  Real lambda, mu, kappa;                      // λ without the share of nodal pressure [Pa]
  Real guard_modulus, guard_below;             // M [Pa] and J₀ of fem/guard.h, 0 without a guard
};

// A symmetric matrix without its diagonal, by the half below: panels of eight columns, each of tiles of sixteen rows from
// the tile on in which the panel begins, and a tile column by column. What lies on the diagonal, above it or beyond the
// matrix is zero.
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

// C += sign A B, with A of rows × depth, B of depth × columns; entry (i, j) of a factor is at i × row + j × column.
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
  bool lower;  // of C, nothing is wanted above the diagonal
  Real* C;     // column by column
  std::size_t stride;
};
inline constexpr Index product_depth = 192, product_height = 256;  // of the blocks in which it is done
inline std::size_t product_scratch(Index columns) {
  return std::size_t(product_depth) * std::size_t(product_height + columns + 8);
}

template <class Real>
struct WideKernels {
  // Adds the forces of the patch's tetrahedra to those of its vertices [N], tetrahedron by tetrahedron. Returns the
  // smallest det F if asked, to rounding, else 1.
  Real (*add_forces)(const PatchArrays<Real>& patch, ElementPart part, Guarding guarding,
                     PaddedVector<Real>* f);
  void (*volume_strains)(const PatchArrays<Real>& patch, Real* rows);  // V tr E [m³], block by block
  // Adds three of the six entries of what each vertex feels when it moves alone [N/m]; returns the smallest det F.
  Real (*add_stiffness)(const PatchArrays<Real>& patch, StiffnessPart part, PaddedVector<Real>* K);
  // The same of the terms of the stored evaluator, carrier by carrier.
  void (*add_term_forces)(const TermArrays<Real>& patch, PaddedVector<Real>* f);
  // Adds to y what the panels [begin, end) of a symmetric matrix make of x, both filled up to whole tiles.
  void (*symmetric_product)(const Real* tiles, SymmetricHalf shape, const Real* x, Index begin, Index end,
                            Real* y);
  void (*add_product)(const MatrixProduct<Real>& product, Real* scratch);  // of product_scratch()
  // The same as add_forces of the edges of a linear patch, of `count` blocks.
  void (*add_edge_forces)(const EdgeBlock<Real>* blocks, Index count, const PaddedVector<Real>* u,
                          PaddedVector<Real>* f);
};

template <class Real>
WideKernels<Real> wide_kernels(InstructionSet set);  // of an available set

}  // namespace lobe
