// Comparisons and choices, for numbers and for packs of them (numerics/simd.h) alike.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace lobe {

// A mask of the lanes of a pack: all bits of a lane's number, or none.
template <class T>
struct LaneMask {
  using Bit = std::conditional_t<sizeof(typename T::value_type) == 8, std::int64_t, std::int32_t>;
  using Bits [[gnu::vector_size(sizeof(T))]] = Bit;
  Bits lanes;
};

inline bool is_less(double a, double b) { return a < b; }
template <class T>
LaneMask<T> is_less(const T& a, const T& b) {
  return a < b;
}

// Returns a where the condition holds, else b.
inline double pick(bool condition, double a, double b) { return condition ? a : b; }
template <class T>
T pick(const LaneMask<T>& condition, const T& a, const T& b) {
  using Bits = typename LaneMask<T>::Bits;
  return std::bit_cast<T>((condition.lanes & std::bit_cast<Bits>(a)) |
                          (~condition.lanes & std::bit_cast<Bits>(b)));
}

template <class T>
bool any_of(const LaneMask<T>& mask) {
  std::uint64_t words[sizeof(T) / 8], any = 0;
  std::memcpy(words, &mask, sizeof words);
  for (const std::uint64_t word : words) any |= word;
  return any != 0;
}

}  // namespace lobe
