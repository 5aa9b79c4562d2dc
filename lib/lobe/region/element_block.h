// Tetrahedra and edges side by side, as wide kernels read them: every row fills one cache line, a multiple of
// every register's width. Plain arrays.
#pragma once

#include <array>

#include "lobe/types.h"

namespace lobe {

template <class Real>
struct alignas(64) ElementBlock {
  static constexpr int width = 64 / sizeof(Real);  // tetrahedra per block
  using Row = std::array<Real, std::size_t(width)>;

  std::array<Row, 9> alpha{};  // α_1, α_2, α_3 [1/m], column by column
  Row V{};                     // [m³], zero in empty lanes
  std::array<std::array<std::uint8_t, std::size_t(width)>, 4>
      corners{};  // vertices, as the patch numbers them
};

template <class Real>
struct alignas(64) PressureBlock {  // beside each block where nodal pressure is used
  std::array<std::array<Index, ElementBlock<Real>::width>, 4> nodes{};  // of the four corners
};

template <class Real>
struct alignas(64) FibreBlock {  // beside each block where a material has fibres
  std::array<typename ElementBlock<Real>::Row, 3> direction{};  // unit vectors at rest
};

template <class Real>
struct alignas(64) EdgeBlock {
  static constexpr int width = ElementBlock<Real>::width;  // edges per block

  std::array<typename ElementBlock<Real>::Row, 9> K{};  // K_ij [N/m], column by column; zero in empty lanes
  std::array<std::array<std::uint8_t, std::size_t(width)>, 2>
      corners{};  // i and j, as the patch numbers them
};

// A vector of a vertex with a fourth number, zero, so that a register takes it whole.
template <class Real>
struct alignas(4 * sizeof(Real)) PaddedVector {
  std::array<Real, 4> xyz0{};
};

}  // namespace lobe
