// How wide kernels add what they have found for the lanes of a register to the sums of vertices.
#pragma once

#include <cstring>

#include "lobe/numerics/simd.h"

namespace lobe {

// Adds lane by lane, so that the order of the sums, and so their bits, does not depend on the width.
// `numbers`: of the vertices of the lanes of each column.
template <class T, int n, class Numbers, class Real = typename T::value_type>
[[gnu::always_inline]] inline void add_to_vertices(const Eigen::Matrix<T, 3, n>& forces,
                                                   const Numbers& numbers, int first, Real* sums) {
  using Vectors = PaddedVectors<T>;
  using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
  alignas(64) Real at_corners[n][4 * Vectors::count];
  for (int c = 0; c < n; ++c) Vectors::store(forces.col(c), at_corners[c]);
  unrolled<n * Vectors::count>([&](int i) {
    const int lane = i / n, c = i % n;
    Four sum, lane_sum;
    Real* place = sums + 4 * numbers[c][first + lane];
    std::memcpy(&sum, place, sizeof sum);
    std::memcpy(&lane_sum, at_corners[c] + Vectors::offset(lane), sizeof lane_sum);
    sum += lane_sum;
    std::memcpy(place, &sum, sizeof sum);
  });
}

// Prefetches data some blocks ahead. The prefetcher of the processor stops at every page and patch.
template <class Block>
[[gnu::always_inline]] inline void prefetch(const Block* block) {
  const char* bytes = reinterpret_cast<const char*>(block + 4);
  for (std::size_t line = 0; line < sizeof(Block); line += 64) __builtin_prefetch(bytes + line);
}

}  // namespace lobe
