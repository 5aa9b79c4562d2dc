// The thin vector layer: Pack<Real> holds as many values as one register of the instruction set this unit is
// compiled for. Eigen's fixed-size matrices take it as a scalar, so that every formula of this folder is
// written once, for float, double and packs of either.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <utility>

#include "lobe/numerics/lane_mask.h"

namespace lobe {

// Calls body(0), body(1) … body(n − 1), one after the other without a loop.
template <int n, class Body>
[[gnu::always_inline]] inline void unrolled(Body&& body) {
  [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) { (body(i), ...); }
  (std::make_integer_sequence<int, n>());
}

// A register of `bytes` bytes. That number is a part of the type, so that units that are compiled for
// different instruction sets share no function of packs. Each operation acts lane by lane, in IEEE
// arithmetic.
template <std::floating_point Real, int bytes>
class BasicPack {
 public:
  using value_type = Real;
  static constexpr std::size_t size() { return bytes / sizeof(Real); }

  BasicPack() = default;
  // A pack of the same value in each lane. Only a Real or an integer converts by itself.
  template <class Number>
  requires std::is_arithmetic_v<Number>
  explicit(!std::same_as<Number, Real> && !std::same_as<Number, int>) BasicPack(Number value)
      : lanes_(Register{} + static_cast<Real>(value)) {}
  explicit BasicPack(const Real* values) { copy_from(values); }  // takes size() values, of any alignment
  // The pack of value_of(0), value_of(1) … by the number of the lane, an int.
  template <std::invocable<int> ValueOf>
  explicit BasicPack(ValueOf&& value_of) {
    unrolled<int(size())>([&](int lane) { lanes_[lane] = value_of(lane); });
  }

  void copy_from(const Real* values) { std::memcpy(&lanes_, values, sizeof lanes_); }
  void copy_to(Real* values) const { std::memcpy(values, &lanes_, sizeof lanes_); }
  Real operator[](std::size_t lane) const { return lanes_[lane]; }

  BasicPack operator-() const { return of(-lanes_); }
  BasicPack& operator+=(const BasicPack& b) { return *this = *this + b; }
  BasicPack& operator-=(const BasicPack& b) { return *this = *this - b; }
  BasicPack& operator*=(const BasicPack& b) { return *this = *this * b; }
  BasicPack& operator/=(const BasicPack& b) { return *this = *this / b; }
  friend BasicPack operator+(const BasicPack& a, const BasicPack& b) { return of(a.lanes_ + b.lanes_); }
  friend BasicPack operator-(const BasicPack& a, const BasicPack& b) { return of(a.lanes_ - b.lanes_); }
  friend BasicPack operator*(const BasicPack& a, const BasicPack& b) { return of(a.lanes_ * b.lanes_); }
  friend BasicPack operator/(const BasicPack& a, const BasicPack& b) { return of(a.lanes_ / b.lanes_); }
  friend LaneMask<BasicPack> operator<(const BasicPack& a, const BasicPack& b) {
    return {a.lanes_ < b.lanes_};
  }
  friend BasicPack min(const BasicPack& a, const BasicPack& b) {  // a where they are equal or one is NaN
    return of(b.lanes_ < a.lanes_ ? b.lanes_ : a.lanes_);
  }
  friend BasicPack max(const BasicPack& a, const BasicPack& b) {  // a where they are equal or one is NaN
    return of(a.lanes_ < b.lanes_ ? b.lanes_ : a.lanes_);
  }
  friend BasicPack abs(const BasicPack& a) {
    using Bits = typename LaneMask<BasicPack>::Bits;
    constexpr auto all_but_sign = std::numeric_limits<typename LaneMask<BasicPack>::Bit>::max();
    return std::bit_cast<BasicPack>(std::bit_cast<Bits>(a) & (Bits{} + all_but_sign));
  }
  friend BasicPack sqrt(const BasicPack& a) {
    return BasicPack([&](int lane) { return std::sqrt(a.lanes_[lane]); });
  }
  friend Real hmin(const BasicPack& a) {  // the smallest of the lanes
    Real smallest = a.lanes_[0];
    for (std::size_t lane = 1; lane < size(); ++lane)
      if (a.lanes_[lane] < smallest) smallest = a.lanes_[lane];
    return smallest;
  }
  friend Real reduce(const BasicPack& a) {  // the sum, from the first lane to the last
    Real sum = a.lanes_[0];
    for (std::size_t lane = 1; lane < size(); ++lane) sum += a.lanes_[lane];
    return sum;
  }

 private:
  using Register [[gnu::vector_size(bytes)]] = Real;
  static BasicPack of(const Register& lanes) { return std::bit_cast<BasicPack>(lanes); }

  Register lanes_;
};

#if defined(__AVX512F__)
inline constexpr int register_bytes = 64;
#elif defined(__AVX__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif
template <class Real>
using Pack = BasicPack<Real, register_bytes>;

// Loads and stores vectors of four numbers, the last of which is padding. In memory they lie one vector after
// the other; packs have one component of all lanes each. A load or store per component and lane would be
// slow. Instead four registers of whole vectors are transposed in place: register k has those of the lanes k,
// k + 4, k + 8 …
template <class T>  // a pack
class PaddedVectors {
 public:
  using Real = typename T::value_type;
  static constexpr int count = static_cast<int>(T::size());

  template <class Number>
  static Eigen::Matrix<T, 3, 1> load(const Real* vectors, const Number* numbers) {  // one per lane
    if constexpr (count % 4 != 0) {
      return {component(vectors, numbers, 0), component(vectors, numbers, 1), component(vectors, numbers, 2)};
    } else {
      Register r[4];
      for (int k = 0; k < 4; ++k) load_register<count / 4>(vectors, numbers + k, r[k]);
      const Register xy = pick<0, 4, 1, 5>(r[0], r[1]), zw = pick<2, 6, 3, 7>(r[0], r[1]);
      const Register next_xy = pick<0, 4, 1, 5>(r[2], r[3]), next_zw = pick<2, 6, 3, 7>(r[2], r[3]);
      return {std::bit_cast<T>(pick<0, 1, 4, 5>(xy, next_xy)),
              std::bit_cast<T>(pick<2, 3, 6, 7>(xy, next_xy)),
              std::bit_cast<T>(pick<0, 1, 4, 5>(zw, next_zw))};
    }
  }

  // Stores 4 × count numbers; those of a lane's vector start at offset(lane).
  static void store(const Eigen::Matrix<T, 3, 1>& v, Real* vectors) {
    if constexpr (count % 4 != 0) {
      for (int lane = 0; lane < count; ++lane)
        for (int d = 0; d < 4; ++d) vectors[offset(lane) + d] = d < 3 ? Real(v[d][lane]) : Real(0);
    } else {
      const auto x = std::bit_cast<Register>(v[0]), y = std::bit_cast<Register>(v[1]),
                 z = std::bit_cast<Register>(v[2]), zero = Register{};
      const Register xy = pick<0, 4, 1, 5>(x, y), next_xy = pick<2, 6, 3, 7>(x, y);
      const Register zw = pick<0, 4, 1, 5>(z, zero), next_zw = pick<2, 6, 3, 7>(z, zero);
      const Register r[4] = {pick<0, 1, 4, 5>(xy, zw), pick<2, 3, 6, 7>(xy, zw),
                             pick<0, 1, 4, 5>(next_xy, next_zw), pick<2, 3, 6, 7>(next_xy, next_zw)};
      std::memcpy(vectors, r, sizeof r);
    }
  }
  static constexpr int offset(int lane) {
    return count % 4 != 0 ? 4 * lane : count * (lane % 4) + 4 * (lane / 4);
  }

 private:
  using Register [[gnu::vector_size(sizeof(T))]] = Real;

  template <class Number>
  static T component(const Real* vectors, const Number* numbers, int d) {
    return T([&](auto lane) { return vectors[4 * numbers[lane] + d]; });
  }

  // Loads the vectors of the lanes 0, 4, 8 … into one register.
  template <int groups, class Number, class R>
  static void load_register(const Real* vectors, const Number* numbers, R& r) {
    if constexpr (groups == 1) {
      std::memcpy(&r, vectors + 4 * numbers[0], sizeof r);
    } else {
      using Half [[gnu::vector_size(sizeof(R) / 2)]] = Real;
      Half a, b;
      load_register<groups / 2>(vectors, numbers, a);
      load_register<groups / 2>(vectors, numbers + 2 * groups, b);
      join(a, b, r, std::make_integer_sequence<int, 4 * groups>());
    }
  }
  template <class Half, class R, int... i>
  static void join(const Half& a, const Half& b, R& r, std::integer_sequence<int, i...>) {
    r = __builtin_shufflevector(a, b, i...);
  }

  // Picks, in every group of four, numbers of a (0…3) and of b (4…7).
  template <int p, int q, int r, int s>
  static Register pick(const Register& a, const Register& b) {
    return picked<p, q, r, s>(a, b, std::make_integer_sequence<int, count>());
  }
  template <int p, int q, int r, int s, int... i>
  static Register picked(const Register& a, const Register& b, std::integer_sequence<int, i...>) {
    return __builtin_shufflevector(a, b, source(i, i % 4 == 0 ? p : i % 4 == 1 ? q : i % 4 == 2 ? r : s)...);
  }
  static constexpr int source(int lane, int which) {
    return lane / 4 * 4 + (which < 4 ? which : count + which - 4);
  }
};

}  // namespace lobe

namespace Eigen {

template <class Scalar, int bytes>
struct NumTraits<lobe::BasicPack<Scalar, bytes>> : GenericNumTraits<lobe::BasicPack<Scalar, bytes>> {
  using Real = lobe::BasicPack<Scalar, bytes>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

}  // namespace Eigen
