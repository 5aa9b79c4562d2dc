// A condensed hybrid in motion.
#include <doctest/doctest.h>

#include "condense/half_linear.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a million undamped steps of nine tenths of the limit neither grow nor decay") {
  Setup setup = half_linear(RegionModel::precomputed, 2);
  World<double> world(setup);
  world.set_state(random_state(world, 1e-5));
  const double dt = 0.9 * world.time_step_limit();
  const auto largest_energy = [&](int steps) {
    double largest = 0;
    for (int i = 0; i < steps; ++i) {
      world.step(dt);
      if (i % 97 == 0) largest = std::max(largest, world.energies().total());
    }
    return largest;
  };
  const double first = largest_energy(20000);
  largest_energy(960000);
  const double last = largest_energy(20000);
  CHECK(first > 0);
  CHECK(last < 1.2 * first);
  CHECK(last > first / 1.2);
}

TEST_CASE("a step beyond the limit of a condensed hybrid grows: the limit is no wider than it says") {
  World<double> world(half_linear(RegionModel::precomputed, 2));
  world.set_state(random_state(world, 1e-9));
  const double dt = 1.1 * world.time_step_limit(), energy = world.energies().total();
  int steps = 0;
  while (steps < 200 && world.energies().total() < 1e3 * energy) {
    world.step(dt);
    ++steps;
  }
  CHECK(steps < 200);
}

TEST_CASE(
    "where the gesture is slow against waves in the region, the condensed hybrid moves as tensor-mass") {
  const auto played = [](RegionModel model, double duration) {
    Setup setup = half_linear(model, 3);
    setup.damping = 20;
    const double end = setup.mesh.points.row(0).maxCoeff();
    setup.grasps.push_back({"grasper", {}, {{0, {0, 0, 0}}, {duration, {0, 0.002, 0.002}}}, false});
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (setup.mesh.points(0, v) > end - 0.004) setup.grasps[0].vertices.push_back(v);
    World<double> world(setup);
    Mat3X<double> u(3, 0);
    for (int i = 0; i < 10; ++i) {
      REQUIRE(world.advance(duration / 10).ok);
      const Mat3X<double> before = u;
      u.resize(3, before.cols() + setup.mesh.vertex_count());
      u << before, world.state().u;
    }
    return u;
  };
  const auto error = [&](double duration) {
    const Mat3X<double> exact = played(RegionModel::tensor_mass, duration);
    return (played(RegionModel::precomputed, duration) - exact).norm() / exact.norm();
  };
  const double fast = error(0.05), slow = error(1.0);
  CAPTURE(fast);
  CAPTURE(slow);
  CHECK(slow < 0.01);
  CHECK(slow < fast / 2);
}
