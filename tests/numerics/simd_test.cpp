#include "lobe/numerics/simd.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

using namespace lobe;

namespace {

template <class Real>
bool same_bits(Real a, Real b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Numbers of both signs, both zeros, infinity and a subnormal number.
template <class Real>
std::vector<Real> some_numbers() {
  using Limits = std::numeric_limits<Real>;
  return {Real(1.5),          Real(-2.25),          Real(0),     -Real(0),
          Limits::infinity(), Limits::denorm_min(), Real(-7e-3), Real(3e8)};
}

}  // namespace

TEST_CASE_TEMPLATE("a pack computes in each lane what a number does", Real, float, double) {
  using T = Pack<Real>;
  const std::vector<Real> numbers = some_numbers<Real>();
  for (std::size_t shift = 0; shift < numbers.size(); ++shift) {
    const auto a_of = [&](int lane) { return numbers[std::size_t(lane) % numbers.size()]; };
    const auto b_of = [&](int lane) { return numbers[(std::size_t(lane) + shift) % numbers.size()]; };
    const T a(a_of), b(b_of);
    const T sum = a + b, difference = a - b, product = a * b, quotient = a / b, opposite = -a;
    const T least = min(a, b), most = max(a, b), size = abs(a), root = sqrt(abs(a));
    for (int lane = 0; lane < int(T::size()); ++lane) {
      const auto i = std::size_t(lane);
      const Real x = a_of(lane), y = b_of(lane);
      const auto equals = [](Real pack, Real number) {
        return same_bits(pack, number) || (std::isnan(pack) && std::isnan(number));
      };
      CHECK(equals(sum[i], x + y));
      CHECK(equals(difference[i], x - y));
      CHECK(equals(product[i], x * y));
      CHECK(equals(quotient[i], x / y));
      CHECK(equals(opposite[i], -x));
      CHECK(equals(least[i], std::min(x, y)));
      CHECK(equals(most[i], std::max(x, y)));
      CHECK(equals(size[i], std::abs(x)));
      CHECK(equals(root[i], std::sqrt(std::abs(x))));
    }
  }
}

TEST_CASE_TEMPLATE("lanes of a pack are compared, chosen and gathered each for itself", Real, float, double) {
  using T = Pack<Real>;
  const T ramp([](int lane) { return Real(lane); }), middle(Real(T::size()) / 2);
  const T chosen = pick(is_less(ramp, middle), ramp, T(-1));
  for (std::size_t lane = 0; lane < T::size(); ++lane)
    CHECK(chosen[lane] == (2 * lane < T::size() ? Real(lane) : Real(-1)));
  CHECK(any_of(ramp < T(1)));
  CHECK_FALSE(any_of(ramp < T(0)));
  for (int lane = 0; lane < int(T::size()); ++lane)
    CHECK(any_of(T([&](int i) { return Real(i == lane ? -1 : 1); }) < T(0)));
  CHECK(hmin(T([](int lane) { return Real(3 - lane); })) == Real(4) - Real(T::size()));
  CHECK(reduce(ramp) == Real(T::size() * (T::size() - 1) / 2));
}

TEST_CASE_TEMPLATE("a pack is loaded from and stored to numbers of any alignment", Real, float, double) {
  using T = Pack<Real>;
  std::vector<Real> from(T::size() + 1), to(T::size() + 3, Real(-1));
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = Real(i);
  T(&from[1]).copy_to(&to[2]);
  for (std::size_t i = 0; i < T::size(); ++i) CHECK(to[i + 2] == Real(i + 1));
  CHECK(to[1] == -1);
  CHECK(to.back() == -1);
}
