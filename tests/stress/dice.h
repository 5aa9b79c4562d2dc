// Random numbers of a test, the same in each run.
#pragma once

#include <random>

#include "lobe/types.h"

namespace lobe::test {

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }
  int among(int first, int last) { return std::uniform_int_distribution<int>(first, last)(random_); }
  Index below(Index count) { return among(0, count - 1); }
  bool says(double probability) { return between(0, 1) < probability; }
  Vec3d vector(double from, double to) { return {between(from, to), between(from, to), between(from, to)}; }

 private:
  std::mt19937 random_;
};

}  // namespace lobe::test
