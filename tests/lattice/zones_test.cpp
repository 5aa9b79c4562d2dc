#include "lobe/lattice/zones.h"

#include <doctest/doctest.h>

#include "lattice_support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("vertices around what is touched are full until a while after, all vertices for a shorter while") {
  const Elements elements(setup_of(box_mesh({0.08, 0.01, 0.01}, 8, 1, 1)));
  const auto at = [&](double x) {
    for (Index v = 0; v < elements.topology.vertex_count(); ++v)
      if ((elements.points.col(v) - Vec3d(x, 0, 0)).norm() < 1e-9) return v;
    return Index(-1);
  };
  FullZones zones;
  zones.look(elements, 0.05, 0, {});
  CHECK_FALSE(zones.is_full(at(0), 0));
  zones.look(elements, 0.05, 1, {at(0)});  // reaches 2 cm
  CHECK(zones.is_full(at(0), 1));
  CHECK(zones.is_full(at(0.02), 1));
  CHECK_FALSE(zones.is_full(at(0.03), 1));
  zones.look(elements, 0.05, 5, {at(0)});
  CHECK(zones.is_full(at(0.02), 5.1));
  zones.look(elements, 0.05, 6, {});  // it lets go
  CHECK(zones.is_full(at(0.08), 6));
  CHECK(zones.is_full(at(0.08), 6.19));
  CHECK_FALSE(zones.is_full(at(0.08), 6.2));
  FullZones other;
  other.set_state(zones.state());
  CHECK(other.is_full(at(0.08), 6.1));
  CHECK(other.state().touched == zones.state().touched);
}
