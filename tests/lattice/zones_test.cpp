#include "lobe/lattice/zones.h"

#include <doctest/doctest.h>

#include "lattice_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Index vertex_at(const Elements& elements, double x) {
  for (Index v = 0; v < elements.topology.vertex_count(); ++v)
    if ((elements.points.col(v) - Vec3d(x, 0, 0)).norm() < 1e-9) return v;
  return -1;
}

FullZones::Sight touch(const std::vector<Index>& held, const std::vector<Index>& loaded,
                       const std::vector<Index>& pressed = {}) {
  FullZones::Sight sight;
  sight.held = held;
  sight.loaded = loaded;
  sight.pressed = pressed;
  return sight;
}

}  // namespace

TEST_CASE(
    "vertices around what is touched are full until a while after, all where tools take hold or let go") {
  const Elements elements(setup_of(box_mesh({0.08, 0.01, 0.01}, 8, 1, 1)));
  const auto at = [&](double x) { return vertex_at(elements, x); };
  FullZones zones;
  zones.look(elements, 0.05, 0, {});
  CHECK_FALSE(zones.is_full(at(0), 0));
  zones.look(elements, 0.05, 1, touch({at(0)}, {}));  // reaches 2 cm
  CHECK(zones.is_full(at(0), 1.06));
  CHECK(zones.is_full(at(0.02), 1.06));
  CHECK(zones.is_full(at(0.03), 1.04));
  CHECK_FALSE(zones.is_full(at(0.03), 1.06));
  zones.look(elements, 0.05, 5, touch({at(0)}, {}));
  CHECK(zones.is_full(at(0.02), 5.24));
  CHECK_FALSE(zones.is_full(at(0.08), 5));
  zones.look(elements, 0.05, 6, touch({}, {at(0.08)}));
  CHECK(zones.is_full(at(0.04), 6.04));
  CHECK_FALSE(zones.is_full(at(0.04), 6.06));
  CHECK(zones.is_full(at(0.06), 6.06));
  zones.look(elements, 0.05, 7, touch({}, {at(0.07)}));  // slides
  CHECK_FALSE(zones.is_full(at(0.04), 7));
  zones.look(elements, 0.01, 8, touch({}, {at(0.05)}));  // reaches 4 mm, but its neighbours at least
  CHECK(zones.is_full(at(0.06), 8.1));
  CHECK_FALSE(zones.is_full(at(0.07), 8.1));
  FullZones other;
  other.set_state(zones.state());
  CHECK(other.is_full(at(0.06), 8.1));
  CHECK(other.state().touched == zones.state().touched);
}

TEST_CASE(
    "who takes hold of a body near rest makes its zone full, and all of it at first and when displaced") {
  const Elements elements(setup_of(box_mesh({0.08, 0.01, 0.01}, 8, 1, 1)));
  const Index near = vertex_at(elements, 0), far = vertex_at(elements, 0.08);
  FullZones zones;
  const auto look = [&](double time, const std::vector<Index>& held, double displacement) {
    FullZones::Sight sight = touch(held, {});
    sight.displacement = displacement;
    zones.look(elements, 0.01, time, sight);
    CHECK(zones.is_full(near, time));
    return zones.is_full(far, time);
  };
  CHECK(look(0, {near}, 0));  // the first hold
  CHECK_FALSE(look(1, {near}, 1));
  CHECK(look(2, {}, 0));  // it lets go
  const FullZones::State free = zones.state();
  CHECK_FALSE(look(4, {near}, 0.099));  // a tenth of the largest displacement is near rest no more
  zones.set_state(free);
  CHECK(look(4, {near}, 0.1));
}

TEST_CASE("what contact presses is full further around, and grows only when it comes to the border") {
  const Elements elements(setup_of(box_mesh({0.16, 0.01, 0.01}, 16, 1, 1)));
  const auto at = [&](double x) { return vertex_at(elements, x); };
  constexpr double cell = 0.026;  // reaches 3.1 cm
  FullZones zones;
  zones.look(elements, cell, 1, touch({}, {}, {at(0.04)}));
  CHECK(zones.is_full(at(0.07), 1));
  CHECK_FALSE(zones.is_full(at(0.08), 1));
  CHECK(zones.is_full(at(0.01), 1.25));
  zones.look(elements, cell, 1.02, touch({}, {}, {at(0.05)}));  // slides inside of the zone
  CHECK_FALSE(zones.is_full(at(0.08), 1.02));
  zones.look(elements, cell, 1.04, touch({}, {}, {at(0.07)}));  // its neighbour is not full
  CHECK(zones.is_full(at(0.10), 1.04));
  CHECK_FALSE(zones.is_full(at(0.11), 1.04));
  // What it has left is embedded again at a multiple of 0.1 s, and not before 0.25 s.
  CHECK(zones.is_full(at(0.02), 1.02 + 0.25));
  CHECK(zones.is_full(at(0.02), 1.29));
  CHECK_FALSE(zones.is_full(at(0.02), 1.3));
  FullZones restored;
  restored.set_state(zones.state());
  for (FullZones* each : {&zones, &restored})
    each->look(elements, cell, 1.06, touch({}, {at(0.16)}, {at(0.08)}));
  CHECK(restored.state().until == zones.state().until);
  CHECK(zones.is_full(at(0.15), 1.06));
}

TEST_CASE("all is full while the body is quick in comparison with how far it has ever moved") {
  const Elements elements(setup_of(box_mesh({0.08, 0.01, 0.01}, 8, 1, 1)));
  FullZones zones;
  const auto is_full = [&](double time, double displacement, double speed, double damping) {
    zones.look(elements, 0.05, time, {{}, {}, {}, displacement, speed, damping});
    return zones.is_full(0, time);
  };
  CHECK(is_full(1, 0.001, 0.01, 0));
  CHECK_FALSE(is_full(2, 0.001, 0.007, 0));
  CHECK(is_full(3, 0.001, 0.01, 20));
  CHECK_FALSE(is_full(4, 0.001, 0.01, 40));  // what damping ends sooner is wrong by less
  CHECK_FALSE(is_full(5, 0.01, 0.01, 0));
  CHECK_FALSE(is_full(6, 0.001, 0.01, 0));  // has been further
  CHECK_FALSE(is_full(7, 0, 0, 0));
}

TEST_CASE("what is to be full is so until the next multiple of a tenth of a second, and no longer") {
  const Elements elements(setup_of(box_mesh({0.08, 0.01, 0.01}, 8, 1, 1)));
  const Index count = elements.topology.vertex_count();
  FullZones zones;
  zones.ask({2, 5}, count, 1.23);
  CHECK(zones.is_full(2, 1.29));
  CHECK(zones.is_full(5, 1.29));
  CHECK_FALSE(zones.is_full(2, 1.31));
  CHECK_FALSE(zones.is_full(3, 0));
  zones.ask({2}, count, 0.5);  // an earlier end changes nothing
  CHECK(zones.is_full(2, 1.29));
  zones.ask({5}, count, 2);
  CHECK(zones.is_full(5, 1.99));
  CHECK_FALSE(zones.is_full(2, 1.99));
}
