// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/contact/gap_kernels.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "lobe/numerics/lane_mask.h"
#include "lobe/numerics/simd.h"
#include "lobe/types.h"

namespace lobe::LOBE_KERNELS {
namespace {

template <class Real>
using Register [[gnu::vector_size(sizeof(Pack<Real>))]] = Real;

template <class V>
V least(const V& a, const V& b) {
  return a < b ? a : b;
}
template <class V>
V most(const V& a, const V& b) {
  return a > b ? a : b;
}

template <class Vector>
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class Vector>
auto dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

LOBE_FLATTEN void find_gaps(const float* places, float share, PairBlock* blocks, int block_count) {
  using T = Pack<float>;
  using Vector = Vec3<T>;
  constexpr int count = static_cast<int>(T::size());
  static_assert(PairBlock::width % count == 0);
  for (PairBlock* block = blocks; block != blocks + block_count; ++block)
    for (std::size_t first = 0; first < PairBlock::width; first += count) {
      const auto place = [&](std::size_t c) {
        return PaddedVectors<T>::load(places, &block->places[c][first]);
      };
      const auto a = [&](std::size_t i) { return T(&block->normal[i][first]); };
      const Vector from = place(3), e1 = place(4) - from, e2 = place(5) - from, e3 = place(6) - from;
      const Vector n = cross(e2, e3) * a(0) + cross(e3, e1) * a(1) + cross(e1, e2) * a(2);
      const auto along = [&](const Vector& x) { return std::bit_cast<Register<float>>(dot(n, x)); };
      const Register<float> zero{};
      const auto inside = most(most(along(e1), along(e2)), most(along(e3), zero));
      const auto x = along(place(0) - from), y = along(place(1) - from), z = along(place(2) - from);
      const auto outside = (x + y + z) * ((1 - share) / 3) + least(least(x, y), z) * share;
      const T gap = std::bit_cast<T>(outside - inside) / sqrt(dot(n, n));
      gap.copy_to(&block->gap[first]);
    }
}

LOBE_FLATTEN void find_insides(const double* places, const double* points, int point_count, double slack,
                               const PairBlock* blocks, InsideBlock* insides, int block_count) {
  using T = Pack<double>;
  using Vector = Vec3<T>;
  constexpr int count = static_cast<int>(T::size());
  static_assert(PairBlock::width % count == 0);
  for (int i = 0; i < block_count; ++i)
    for (std::size_t first = 0; first < PairBlock::width; first += count) {
      const auto place = [&](std::size_t c) {
        return PaddedVectors<T>::load(places, &blocks[i].places[c][first]);
      };
      const auto store = [&](const T& value, InsideBlock::Row& row) { value.copy_to(&row[first]); };
      const Vector from = place(3), e1 = place(4) - from, e2 = place(5) - from, e3 = place(6) - from;
      const Vector across[3] = {cross(e2, e3), cross(e3, e1), cross(e1, e2)};
      const T six_volumes = dot(e1, across[0]), inverse = T(1) / six_volumes;
      T b[3][3];  // of each corner
      for (std::size_t c = 0; c < 3; ++c) {
        const Vector x = place(c) - from;
        for (std::size_t k = 0; k < 3; ++k) {
          b[c][k] = dot(x, across[k]) * inverse;
          store(b[c][k], insides[i].weights[c][k]);
        }
      }
      T inside = T(0);
      for (int p = 0; p < point_count; ++p) {
        const double* w = points + 3 * p;
        T own[3];
        for (int k = 0; k < 3; ++k) own[k] = T(w[0]) * b[0][k] + T(w[1]) * b[1][k] + T(w[2]) * b[2][k];
        const auto lanes = [](const T& value) { return std::bit_cast<Register<double>>(value); };
        const auto lowest = least(least(lanes(own[0]), lanes(own[1])),
                                  least(lanes(own[2]), lanes(T(1) - (own[0] + own[1] + own[2]))));
        inside += pick(is_less(T(-slack), std::bit_cast<T>(lowest)), T(double(1 << p)), T(0));
      }
      store(pick(is_less(T(0), six_volumes), inside, T(-1)), insides[i].points);
    }
}

// From the first place that is aligned on, three registers after each other have each component in the same
// lanes. Numbers of `from` lie like those of u, so that no register straddles two lines of the cache.
template <class Real>
LOBE_FLATTEN double range(const Real* u, const Real* from, int vertices) {
  using V = Register<Real>;
  constexpr int count = static_cast<int>(sizeof(V) / sizeof(Real));
  constexpr Real infinity = std::numeric_limits<Real>::infinity();
  Real lowest[3] = {infinity, infinity, infinity}, highest[3] = {-infinity, -infinity, -infinity};
  const auto take = [&](int i) {
    const Real difference = u[i] - from[i];
    lowest[i % 3] = least(lowest[i % 3], difference);
    highest[i % 3] = most(highest[i % 3], difference);
  };
  const auto load = [](const Real* at) {
    V value;
    std::memcpy(&value, at, sizeof value);
    return value;
  };
  const int end = 3 * vertices;
  const auto beyond = static_cast<int>(reinterpret_cast<std::uintptr_t>(u) % sizeof(V) / sizeof(Real));
  int i = 0;
  for (; i < (count - beyond) % count && i < end; ++i) take(i);
  const int first = i;
  V low[3], high[3];
  for (int r = 0; r < 3; ++r) {
    low[r] = V{} + infinity;
    high[r] = V{} - infinity;
  }
  for (; i + 3 * count <= end; i += 3 * count)
    unrolled<3>([&](int r) {
      const V difference = load(u + i + r * count) - load(from + i + r * count);
      low[r] = least(low[r], difference);
      high[r] = most(high[r], difference);
    });
  for (; i < end; ++i) take(i);
  for (int r = 0; r < 3; ++r)
    for (int lane = 0; lane < count; ++lane) {
      const int d = (first + r * count + lane) % 3;
      lowest[d] = least(lowest[d], low[r][lane]);
      highest[d] = most(highest[d], high[r][lane]);
    }
  double square = 0;
  for (int d = 0; d < 3 && vertices > 0; ++d)
    square += (double(highest[d]) - double(lowest[d])) * (double(highest[d]) - double(lowest[d]));
  return std::sqrt(square);
}

double float_range(const float* u, const float* from, int vertices) { return range(u, from, vertices); }
double double_range(const double* u, const double* from, int vertices) { return range(u, from, vertices); }

}  // namespace

extern const GapKernels self_gap_kernels{find_gaps, find_insides, float_range, double_range};

}  // namespace lobe::LOBE_KERNELS
