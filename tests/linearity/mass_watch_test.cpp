#include "lobe/linearity/mass_watch.h"

#include <doctest/doctest.h>

#include "liver.h"
#include "lobe/sim/checkpoint.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Its left lobe is lifted in 0.3 s, held, let go after 0.5 s.
Setup lifted_liver(int degree) {
  Setup setup = held_liver();
  setup.damping = 20;
  setup.selective_mass = degree;
  setup.grasps = {{"grasper",
                   left_lobe(setup),
                   {{0, Vec3d::Zero()}, {0.3, Vec3d(0.004, -0.004, 0.03)}, {0.5, Vec3d(0.004, -0.004, 0.03)}},
                   true}};
  return setup;
}

double mass_norm(World<double>& world, const Mat3X<double>& u) {
  double sum = 0;
  for (Index v = 0; v < u.cols(); ++v)
    sum += world.body().inertia.mass()[std::size_t(v)] * u.col(v).squaredNorm();
  return std::sqrt(sum);
}

}  // namespace

TEST_CASE("in every frame of a pull and a release the error is below the tolerance, and steps are saved") {
  constexpr double tolerance = 0.02;
  World<double> exact(lifted_liver(1)), world(lifted_liver(12));
  MassWatch<double> watch(world, tolerance);
  CHECK(watch.look(world).degree == 1);  // a motion begins
  double largest = 0, least_ratio = 10, most_ratio = 0;
  int compared = 0, steps = 0, exact_steps = 0, lumped = 0, highest = 0;
  while (world.time() < 1.2) {
    exact_steps += exact.advance(1.0 / 30).steps;
    steps += world.advance(1.0 / 30).steps;
    const MassReport seen = watch.look(world);
    largest = std::max(largest, mass_norm(exact, exact.state().u));
    const double error = mass_norm(exact, world.state().u - exact.state().u) / largest;
    CAPTURE(world.time());
    CHECK(error < tolerance);
    CHECK(seen.error >= 0);
    if (error > tolerance / 4) {
      ++compared;
      least_ratio = std::min(least_ratio, seen.error / error);
      most_ratio = std::max(most_ratio, seen.error / error);
    }
    lumped += seen.degree == 1;
    highest += seen.degree == 12;
  }
  CHECK(compared > 5);
  CHECK(least_ratio > 0.2);
  CHECK(most_ratio < 5);
  CHECK(steps < 0.6 * exact_steps);
  CHECK(lumped > 2);
  CHECK(highest > 5);
}

TEST_CASE("without a watch the same masses are wrong by more than 5 % after the release") {
  World<double> exact(lifted_liver(1)), world(lifted_liver(12));
  double largest = 0, worst = 0;
  while (world.time() < 0.8) {
    exact.advance(1.0 / 30);
    world.advance(1.0 / 30);
    largest = std::max(largest, mass_norm(exact, exact.state().u));
    if (world.time() > 0.5)
      worst = std::max(worst, mass_norm(exact, world.state().u - exact.state().u) / largest);
  }
  CHECK(worst > 0.05);
}

TEST_CASE("who sets a degree that exceeds the tolerance is told, with the place") {
  World<double> world(lifted_liver(12));
  std::vector<MassReport> told;
  MassWatch<double> watch(world, 0.02, [&](const MassReport& report) { told.push_back(report); });
  watch.look(world);
  while (world.time() < 0.49) {
    REQUIRE(world.advance(1.0 / 30).ok);
    watch.look(world);
  }
  CHECK(told.empty());
  world.apply(SetMassDegree{12});  // where it is let go
  REQUIRE(world.advance(1.0 / 30).ok);
  CHECK(watch.look(world).exceeded);
  REQUIRE(told.size() == 1);
  CHECK(told[0].error > 0.02);
  CHECK(told[0].time == world.time());
  CHECK(told[0].place.x() > 0);  // in the half that was held; the clamp ends at -0.02
}

TEST_CASE("masses of a body that nothing holds stay lumped") {
  Setup setup = held_liver();
  setup.prescribed.clear();
  setup.selective_mass = 9;
  World<double> world(setup);
  MassWatch<double> watch(world, 0.02);
  for (int i = 0; i < 5; ++i) {
    CHECK(watch.look(world).degree == 1);
    REQUIRE(world.advance(0.01).ok);
  }
}

// Without a count of restorations, the world has as many edits as before, and the later cut is not seen.
TEST_CASE("a cut after the world was put back to before another one lowers the degree") {
  constexpr int most_where_cut = 5;
  constexpr double frame = 0.01;
  const std::vector<Index> first{10}, second{300};
  World<double> world(lifted_liver(12));
  MassWatch<double> watch(world, 0.02);
  int degree = watch.look(world).degree;
  const auto look_after_frame = [&] {
    REQUIRE(world.advance(frame).ok);
    return watch.look(world).degree;
  };
  while (world.time() < 1.2) degree = look_after_frame();
  REQUIRE(degree > most_where_cut);
  const Checkpoint<double> kept = world.save();
  world.remove_tets(first);
  CHECK(look_after_frame() <= most_where_cut);
  CHECK(look_after_frame() > most_where_cut);  // a cut counts once

  world.restore(kept);
  for (int i = 0; i < 2; ++i) REQUIRE(world.advance(frame).ok);
  world.remove_tets(second);
  REQUIRE(world.journal().edits.size() == kept.history.size() + 1);
  CHECK(look_after_frame() <= most_where_cut);
  CHECK(look_after_frame() > most_where_cut);
}

TEST_CASE("who goes back in time begins again, with lumped masses and no error") {
  World<double> world(lifted_liver(12));
  MassWatch<double> watch(world, 0.02);
  watch.look(world);
  const Checkpoint<double> start = world.save();
  while (world.time() < 0.3) {
    REQUIRE(world.advance(1.0 / 30).ok);
    watch.look(world);
  }
  world.restore(start);
  const MassReport seen = watch.look(world);
  CHECK(seen.time == 0);
  CHECK(seen.degree == 1);
  CHECK(seen.error == 0);
}
