// Tetrahedra side by side, as wide kernels read them: every row fills one cache line, a multiple of every
// register's width. Plain arrays.
#pragma once

#include <array>

#include "lobe/types.h"

namespace lobe {

template <class Real>
struct alignas(64) ElementBlock {
  static constexpr int width = 64 / sizeof(Real);  // tetrahedra per block
  using Row = std::array<Real, std::size_t(width)>;
  using IndexRow = std::array<Index, std::size_t(width)>;

  std::array<Row, 9> alpha{};         // α_1, α_2, α_3 [1/m], column by column
  Row lambda_V{}, mu_V{}, kappa_V{};  // [J], λ without the share of nodal pressure; zero in empty lanes
  std::array<IndexRow, 4> corners{};
};

template <class Real>
struct alignas(64) PressureBlock {       // beside each block where a material asks for nodal pressure
  typename ElementBlock<Real>::Row V{};  // [m³]
  std::array<typename ElementBlock<Real>::IndexRow, 4> nodes{};  // of the four corners
};

}  // namespace lobe
