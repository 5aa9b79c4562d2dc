// Blocks of stored terms, as wide kernels read them. These are plain arrays.
#pragma once

#include "lobe/region/element_block.h"
#include "paper/nonlinear_tensor_mass.h"

namespace lobe {

template <class Real, class Terms>
struct alignas(64) TermBlock {
  static constexpr int width =
      64 / sizeof(Real);  // carriers (vertices, edges, triangles, tetrahedra) per block

  std::array<std::array<Real, std::size_t(width)>, std::size_t(Terms::size)> values{};  // zero in empty lanes
  std::array<std::array<std::uint8_t, std::size_t(width)>, std::size_t(Terms::vertices)> vertices{};
};

template <class Real, class Terms>
struct TermBlocks {
  const TermBlock<Real, Terms>* blocks;
  Index count;
};

template <class Real>
struct TermArrays {  // of one patch
  TermBlocks<Real, VertexTerms> vertices;
  TermBlocks<Real, EdgeTerms> edges;
  TermBlocks<Real, TriangleTerms> triangles;
  TermBlocks<Real, TetTerms> tets;
  const PaddedVector<Real>* u;  // per vertex of the patch [m]
};

}  // namespace lobe
