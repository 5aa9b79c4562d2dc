// Comparisons and choices, for numbers and for packs of them (numerics/simd.h) alike. The where() of
// libstdc++ 12 assigns nothing when Clang compiles it for AVX-512.
#pragma once

#include <bit>
#include <cstdint>

namespace lobe {

// Of each lane of a pack: all bits of its number, or none.
template <class T>
struct LaneMask {
  using Register [[gnu::vector_size(sizeof(T))]] = typename T::value_type;
  using Bits [[gnu::vector_size(sizeof(T))]] = std::int64_t;
  static_assert(sizeof(typename T::value_type) == sizeof(std::int64_t));
  Bits lanes;
};

inline bool is_less(double a, double b) { return a < b; }
template <class T>
LaneMask<T> is_less(const T& a, const T& b) {
  using Register = typename LaneMask<T>::Register;
  return {std::bit_cast<Register>(a) < std::bit_cast<Register>(b)};
}

// a where the condition holds, else b.
inline double pick(bool condition, double a, double b) { return condition ? a : b; }
template <class T>
T pick(const LaneMask<T>& condition, const T& a, const T& b) {
  using Bits = typename LaneMask<T>::Bits;
  return std::bit_cast<T>((condition.lanes & std::bit_cast<Bits>(a)) |
                          (~condition.lanes & std::bit_cast<Bits>(b)));
}

}  // namespace lobe
