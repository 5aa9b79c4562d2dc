#include "lobe/condense/condensing_log.h"

#include <doctest/doctest.h>

#include "condense/half_linear.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("condensing tells how far it is and what it took") {
  std::vector<double> fractions;
  World<double> world(half_linear(RegionModel::precomputed), 1,
                      [&](double fraction) { fractions.push_back(fraction); });
  CHECK(fractions == std::vector<double>{1.0 / 3, 2.0 / 3, 1});
  for (double seconds : world.body().regions.condensing().seconds()) CHECK(seconds > 0);
}
