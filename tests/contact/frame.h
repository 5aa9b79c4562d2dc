// How long the frames of these tests are.
#pragma once

namespace lobe::test {

inline constexpr double frame = 0.02;  // [s]

}  // namespace lobe::test
