// How tests compare numbers.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <ostream>

namespace lobe::test {

// Equal but for this share of the larger of the two. doctest::Approx(x).epsilon(e) allows e (1 + |x|), which
// is absolute where x is far below 1, as most figures in SI units are: refuse_approx.cmake refuses it
// elsewhere. Zero has no relative tolerance: compare std::abs(a) with an absolute one.
inline doctest::Approx near(double value, double relative) {
  return doctest::Approx(value).epsilon(relative).scale(0);
}

// Equal but for this share of what the two are small beside, such as the norm of the vector that they are
// entries of.
struct Near {
  double value, tolerance;
};
inline Near near(double value, double relative, double of) { return {value, relative * of}; }
inline bool operator==(double actual, const Near& expected) {
  return std::abs(actual - expected.value) < expected.tolerance;
}
inline std::ostream& operator<<(std::ostream& out, const Near& expected) {
  return out << expected.value << " ± " << expected.tolerance;
}

}  // namespace lobe::test
