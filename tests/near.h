// How tests compare numbers.
#pragma once

#include <doctest/doctest.h>

namespace lobe::test {

// Equal but for this share of the larger of the two. doctest::Approx(x).epsilon(e) allows e (1 + |x|), which is absolute
// where x is far below 1, as most figures in SI units are: a bare Approx is refused (tests/CMakeLists.txt). Zero has no
// relative tolerance: compare std::abs(a) with an absolute one.
inline doctest::Approx near(double value, double relative) {
  return doctest::Approx(value).epsilon(relative).scale(0);
}

}  // namespace lobe::test
