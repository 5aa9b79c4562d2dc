// Frames that are shorter than the time for which a step limit holds (time/step_limit.h).
#include <doctest/doctest.h>

#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "squeezed_bar.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup swinging_block() {
  Setup setup = setup_of(irregular_box(4));
  setup.gravity = {0, 0, -9.81};
  setup.volume_penalty = 1e5;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

}  // namespace

TEST_CASE("frames of a millisecond look for the step limit once in fifteen of them") {
  Setup setup = swinging_block();
  SUBCASE("") {}
  SUBCASE("with sleep") {
    setup.sleep = 1e-5;
    setup.damping = 20;
  }
  World<double> world(setup);
  world.advance(0.001);
  const std::uint64_t before = world.body().regions.sums_revision();
  for (int i = 0; i < 100; ++i) REQUIRE(world.advance(0.001).ok);
  const std::uint64_t passes = world.body().regions.sums_revision() - before;
  CHECK(passes >= 6);
  CHECK(passes <= 9);  // and where it is measured again
}

TEST_CASE("they go where longer frames go") {
  Setup setup = swinging_block();
  setup.damping = 40;
  World<double> few(setup), many(setup);
  for (int i = 0; i < 10; ++i) few.advance(0.02);
  for (int i = 0; i < 200; ++i) REQUIRE(many.advance(0.001).ok);
  const Mat3X<double> u = few.state().u;
  CHECK(u.norm() > 1e-4);
  CHECK((many.state().u - u).norm() < 0.01 * u.norm());
}

TEST_CASE_TEMPLATE("a world that is restored between two looks goes on with the same bits", Real, float,
                   double) {
  World<Real> world(swinging_block()), restored(swinging_block(), 2);
  for (int i = 0; i < 13; ++i) world.advance(0.001);
  const Checkpoint<Real> kept = world.save();
  restored.restore(kept);
  for (int i = 0; i < 10; ++i) {
    world.advance(0.001);
    restored.advance(0.001);
  }
  CHECK(world.state().u == restored.state().u);
  world.restore(kept);  // to which it goes back by itself as well
  restored.restore(kept);
  for (int i = 0; i < 10; ++i) {
    world.advance(0.001);
    restored.advance(0.001);
  }
  CHECK(world.state().u == restored.state().u);
}

TEST_CASE("an edit between two looks is followed at once") {
  World<double> world(swinging_block());
  for (int i = 0; i < 7; ++i) world.advance(0.001);
  world.remove_tets({100, 101, 102, 140, 141});
  const Report report = world.advance(0.001);
  CHECK(report.ok);
  World<double> fresh(swinging_block());
  fresh.restore(world.save());
  CHECK(world.time_step_limit() == near(fresh.time_step_limit(), 1e-9));
}
