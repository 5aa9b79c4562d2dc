// Blocks of tetrahedra and of edges, as wide kernels read them. Every row of numbers fills one cache line,
// which is a multiple of every register's width. These are plain arrays.
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

// One for each ElementBlock, if nodal pressure is used.
template <class Real>
struct alignas(64) PressureBlock {
  std::array<std::array<Index, ElementBlock<Real>::width>, 4> nodes{};  // nodes of the four corners
};

// One for each ElementBlock, if a material has fibres.
template <class Real>
struct alignas(64) FibreBlock {
  std::array<typename ElementBlock<Real>::Row, 3> direction{};  // unit vectors at rest
};

template <class Real>
struct alignas(64) EdgeBlock {
  static constexpr int width = ElementBlock<Real>::width;  // edges per block

  std::array<typename ElementBlock<Real>::Row, 9> K{};  // K_ij [N/m], column by column; zero in empty lanes
  std::array<std::array<std::uint8_t, std::size_t(width)>, 2>
      corners{};  // i and j, as the patch numbers them
};

// A vector of a vertex, with a fourth number that is zero, so that one load or store takes all of it.
template <class Real>
struct alignas(4 * sizeof(Real)) PaddedVector {
  std::array<Real, 4> xyz0{};
};

}  // namespace lobe
