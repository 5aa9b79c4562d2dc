#include "lobe/linearity/halving.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "lobe/mesh/generators.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("halving gives each tetrahedron a part, and all parts about the same size") {
  const Elements elements(setup_of(box_mesh({0.3, 0.1, 0.1}, 6, 2, 2)));
  const Index tets = elements.topology.tet_count();
  for (Index count : {1, 2, 5, 24, tets}) {
    CAPTURE(count);
    std::vector<Index> size(std::size_t(count), 0);
    for (Index part : parts_by_halving(elements, count)) ++size.at(std::size_t(part));
    const auto [least, most] = std::minmax_element(size.begin(), size.end());
    CHECK(*least >= 1);
    CHECK(*most - *least <= 1);
  }
}

TEST_CASE("halving in two cuts a bar in the middle of its length") {
  const Elements elements(setup_of(box_mesh({0.3, 0.1, 0.1}, 6, 2, 2)));
  const std::vector<Index> part = parts_by_halving(elements, 2);
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    CHECK((elements.corner_points(t).row(0).mean() > 0.15) == (part[std::size_t(t)] == 1));
}
