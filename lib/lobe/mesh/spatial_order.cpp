#include "lobe/mesh/spatial_order.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace lobe {
namespace {

constexpr int bits = 21;  // per axis; three fit a key
using Cell = std::array<std::uint32_t, 3>;

// Every bit of a coordinate followed by two zeros.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

// Place of a cell along the curve. J. Skilling, Programming the Hilbert curve, AIP Conf. Proc. 707, 381
// (2004).
std::uint64_t hilbert_key(Cell x) {
  for (std::uint32_t q = 1u << (bits - 1); q > 1; q >>= 1)
    for (std::uint32_t& c : x) {
      const std::uint32_t low = q - 1, swapped = c & q ? 0 : (x[0] ^ c) & low;
      if (c & q) x[0] ^= low;
      x[0] ^= swapped;
      c ^= swapped;
    }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t flip = 0;
  for (std::uint32_t q = 1u << (bits - 1); q > 1; q >>= 1)
    if (x[2] & q) flip ^= q - 1;
  return spread(x[0] ^ flip) << 2 | spread(x[1] ^ flip) << 1 | spread(x[2] ^ flip);
}

}  // namespace

std::vector<Index> spatial_order(const Mat3X<double>& points) {
  if (points.cols() == 0) return {};
  const Vec3d low = points.rowwise().minCoeff();
  const double size = (points.rowwise().maxCoeff() - low).maxCoeff();
  const double cells = size > 0 ? ((1u << bits) - 1) / size : 0;
  struct Keyed {
    std::uint64_t key;
    Index column;
  };
  std::vector<Keyed> keyed;
  keyed.reserve(std::size_t(points.cols()));
  for (Index i = 0; i < points.cols(); ++i) {
    const Vec3<std::uint32_t> cell = ((points.col(i) - low) * cells).cast<std::uint32_t>();
    keyed.push_back({hilbert_key({cell[0], cell[1], cell[2]}), i});
  }
  std::sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return a.key != b.key ? a.key < b.key : a.column < b.column;
  });
  std::vector<Index> order;
  order.reserve(keyed.size());
  for (const Keyed& k : keyed) order.push_back(k.column);
  return order;
}

}  // namespace lobe
