// The loops over all vertices and over many pairs by which self contact knows that nothing comes near,
// compiled once per instruction set (gap_kernels.cpp). They take plain arrays and share no inline function
// with the rest of the library, as region/wide_kernels.h says.
#pragma once

#include <array>
#include <cstdint>

#include "lobe/instruction_set.h"

namespace lobe {

// Pairs of a triangle and a tetrahedron, side by side. Between the two is a gap along n, which moves with the
// tetrahedron as the normal of a plane in it would: with e_i its edges from its first corner,
//   n = a_1 e_2 × e_3 + a_2 e_3 × e_1 + a_3 e_1 × e_2.
struct alignas(64) PairBlock {
  static constexpr int width = 16;
  std::array<std::array<std::int32_t, width>, 7> places{};  // the triangle's corners, the tetrahedron's
  std::array<std::array<float, width>, 3> normal{};         // a
  std::array<float, width> gap{};                           // [m]
};

// For the pairs of a PairBlock: the barycentric coordinates 1, 2 and 3 of each corner of the triangle in the
// tetrahedron, and which of the triangle's points lie in it.
struct alignas(64) InsideBlock {
  using Row = std::array<double, PairBlock::width>;
  std::array<std::array<Row, 3>, 3> weights{};  // weights[corner][i − 1]
  Row points{};  // bit i: point i, as a number; −1 if the tetrahedron is inverted
};

struct GapKernels {
  // Writes the gap [m] of each pair, from the triangle, scaled by `share` about its centre, to the other.
  // places: positions [m], four numbers each, of which the last is not used. NaN for a normal of 0 and for
  // values that are not finite.
  void (*find_gaps)(const float* places, float share, PairBlock* blocks, int count);
  // Places as before. Points: three weights each. One is inside if no coordinate is below −slack.
  void (*find_insides)(const double* places, const double* points, int point_count, double slack,
                       const PairBlock* blocks, InsideBlock* insides, int count);
  // Returns the diagonal of the box of the #vertices columns u − from: no two of them differ by more. It is
  // fastest if both arrays begin at the same place of a line of the cache.
  double (*float_range)(const float* u, const float* from, int vertices);
  double (*double_range)(const double* u, const double* from, int vertices);
};

GapKernels gap_kernels(InstructionSet set);  // kernels for an available set

}  // namespace lobe
