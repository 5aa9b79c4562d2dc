// The moduli of the solids of these tests.
#pragma once

namespace lobe::test {

constexpr double lambda = 4e4, mu = 1e4;  // [Pa]

}  // namespace lobe::test
