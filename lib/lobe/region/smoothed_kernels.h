// The wide kernels of edge-smoothed tetrahedra (fem/smoothed_edge.h), and the blocks that they read. Like
// those of wide_kernels.h they are compiled once per instruction set and take plain arrays.
#pragma once

#include "lobe/region/wide_kernels.h"

namespace lobe {

// The most vertices of a domain: a byte numbers them, and one may be there twice (tet_owners.h).
inline constexpr int domain_rows = 257;

// As many domains as a row has numbers. Domains of one block have about as many vertices each. Their rows lie
// one after the other in the arrays below.
template <class Real>
struct alignas(64) SmoothedBlock {
  static constexpr int width = ElementBlock<Real>::width;
  using Row = typename ElementBlock<Real>::Row;

  Row V{};             // [m³], zero in empty lanes
  Index vertices = 1;  // most vertices of a domain
  Index first = 0;     // row of gradients of the second vertex
  Index places = 0;    // places for tetrahedra, between the vertices of chains (tet_owners.h)
  Index chain = 0;     // ChainRow of the second vertex, if there are places
};

// One vertex of each domain of a block. A domain with fewer vertices repeats its first, with gradient 0.
template <class Real>
struct alignas(64) GradientRow {
  std::array<typename ElementBlock<Real>::Row, 3> b{};  // [1/m]
};
// One vertex of the chain of each domain of a block: the second vertex, then the chain (TetChain).
template <class Real>
struct alignas(64) ChainRow {
  std::array<typename ElementBlock<Real>::Row, 3> X{};    // place from the domain's first vertex, at rest [m]
  typename ElementBlock<Real>::Row six_V{}, per_six_V{};  // 6φV, 1/6V of a tetrahedron, or 0 [m³], [1/m³]
};
// A vertex by the number n that a patch gives it, kept as 4n: where its PaddedVector begins.
struct PaddedPlace {
  std::uint16_t begin = 0;

  static PaddedPlace of(std::uint8_t number) { return {static_cast<std::uint16_t>(4 * number)}; }
  [[gnu::always_inline]] friend inline std::size_t operator*(int, PaddedPlace place) {
    return place.begin;
  }  // by 4
};
template <class Real>
using NumberRow = std::array<PaddedPlace, std::size_t(ElementBlock<Real>::width)>;

// One for each SmoothedBlock, if a material has nodal pressure.
template <class Real>
struct alignas(64) EndNodeRows {
  std::array<std::array<Index, std::size_t(ElementBlock<Real>::width)>, 2> nodes{};  // nodes of both ends
};
// ∇u of each domain of a block, column by column.
template <class Real>
struct alignas(64) DomainGradients {
  std::array<typename ElementBlock<Real>::Row, 9> entries;
};

// Whether domains have a law of the deformation gradient or the linear one.
enum class Strain : std::uint8_t { finite, small };

template <class Real>
struct SmoothedArrays {  // one patch: all its domains are of one material
  const SmoothedBlock<Real>* blocks;
  Index block_count;
  const GradientRow<Real>* gradients;    // gradients of all vertices but the first
  const NumberRow<Real>* numbers;        // numbers of all vertices in the patch
  const ChainRow<Real>* chains;          // chains of the blocks that have tetrahedra
  const FibreBlock<Real>* fibre_blocks;  // null where no material has fibres
  const EndNodeRows<Real>* node_rows;    // null where no material has nodal pressure
  const Real* pressure;                  // pressure of each node [Pa]
  const PaddedVector<Real>* u;           // displacement of each vertex of the patch [m]
  const DomainGradients<Real>* H;        // gradient of each block where it is known; else null
  Law<Real> law;  // without its pressure and direction; volume term and guard are those of tetrahedra
  Strain strain;
};

template <class Real>
struct SmoothedKernels {
  // Adds the forces of the patch's domains to those of its vertices [N], and the forces of the volume term
  // and the guard of the tetrahedra that they own.
  void (*add_forces)(const SmoothedArrays<Real>& patch, PaddedVector<Real>* f);
  // ∇u, and V θ [m³] (fem/pressure_term.h), block by block.
  void (*find_gradients)(const SmoothedArrays<Real>& patch, DomainGradients<Real>* H, Real* volume_strains);
  // Adds three of the six entries of the stiffness that each vertex feels when it moves while its neighbours
  // are held [N/m]. That of small strain is the one at rest.
  void (*add_stiffness)(const SmoothedArrays<Real>& patch, StiffnessPart part, PaddedVector<Real>* K);
};

template <class Real>
SmoothedKernels<Real> smoothed_kernels(InstructionSet set);  // `set`: an available one

}  // namespace lobe
