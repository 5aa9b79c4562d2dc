// The loop over cells of a lattice, compiled once per instruction set (cell_kernels.cpp). It takes plain
// arrays and shares no inline function with the rest of the library, as region/wide_kernels.h says.
#pragma once

#include <array>

#include "lobe/fem/law_moduli.h"
#include "lobe/instruction_set.h"
#include "lobe/region/element_block.h"

namespace lobe {

// Cells of one material side by side. The first node's gradient and fluctuation are minus the sums of the
// others', which are stored.
template <class Real>
struct alignas(64) CellBlock {
  static constexpr int width = 64 / sizeof(Real);
  using Row = std::array<Real, std::size_t(width)>;

  std::array<Row, 21> gradients{};    // N_1 … N_7 [1/m], component by component
  std::array<Row, 28> fluctuation{};  // S_nm [N/m], n ≥ m ≥ 1, row by row; zero in empty lanes
  Row volume{};                       // V [m³]; zero in empty lanes
  std::array<std::array<Index, std::size_t(width)>, 8> nodes{};
};

template <class Real>
struct CellArrays {
  const CellBlock<Real>* blocks;
  const Law<Real>* laws;        // law of each block
  const PaddedVector<Real>* q;  // displacements of nodes [m]
};

template <class Real>
struct alignas(64) CellTangents {  // tangents of a block
  using Row = typename CellBlock<Real>::Row;
  // Bounds of λ_max of each node's stiffness while the others are held, from the cell's mean strain [N/m].
  std::array<Row, 8> bounds;
  Row volume_ratio;  // det F
};

template <class Real>
struct CellKernels {
  // Finds the forces of the blocks [begin, end) on their nodes: block by block, corner by corner, lane by
  // lane, as PaddedVectors::store() [N].
  void (*find_forces)(const CellArrays<Real>& cells, PaddedVector<Real>* forces, Index begin, Index end);
  void (*find_tangents)(const CellArrays<Real>& cells, CellTangents<Real>* tangents, Index begin, Index end);
  int lanes;  // lanes of a register
};

template <class Real>
CellKernels<Real> cell_kernels(InstructionSet set);  // `set`: an available one

}  // namespace lobe
