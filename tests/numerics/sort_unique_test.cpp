#include "lobe/sort_unique.h"

#include <doctest/doctest.h>

#include <random>
#include <set>

using namespace lobe;

TEST_CASE("a list becomes a set: few numbers, many that lie close together, many that lie far apart") {
  std::mt19937 random(1);
  for (const std::size_t count : {0, 1, 10, 63, 64, 65, 1000, 5000})
    for (const Index most : {0, 1, 63, 64, 1000, 100000, 2147483647}) {
      std::uniform_int_distribution<Index> number(most / 3, most);
      std::vector<Index> list;
      for (std::size_t i = 0; i < count; ++i) list.push_back(number(random));
      const std::set<Index> expected(list.begin(), list.end());
      sort_unique(list);
      CHECK(list == std::vector<Index>(expected.begin(), expected.end()));
    }
}
