#include "lobe/time/mass_scaling.h"

#include <doctest/doctest.h>

#include <numeric>

#include "lobe/io/mesh_io.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("mass is added up to a level that takes all of it, and nowhere else") {
  // 2 (8/4 − 1) + 1 (6/4 − 1) = 2.5
  const std::vector<double> factors = mass_factors({1, 2, 1, 5}, {6, 8, 3, 0}, 2.5);
  CHECK(factors[0] == near(1.5, 1e-12));
  CHECK(factors[1] == near(2, 1e-12));
  CHECK(factors[2] == 1);
  CHECK(factors[3] == 1);
}

TEST_CASE("on a liver 1.5 % of added mass lengthens the step by 19 %, and no more is added") {
  Setup setup = setup_of(read_mesh(LOBE_DATA_DIR "/meshes/liver_2k.vtu").mesh);
  World<double> plain(setup);
  setup.mass_scaling = 0.015;
  World<double> scaled(setup);
  const auto total = [](World<double>& w) {
    return std::accumulate(w.body().inertia.mass().begin(), w.body().inertia.mass().end(), 0.0);
  };
  const double added = total(scaled) - total(plain);
  CHECK(added == near(0.015 * total(plain), 1e-9));
  CHECK(scaled.body().inertia.scaling().added == near(added, 1e-9));
  CHECK(scaled.body().inertia.scaling().share == near(0.015, 1e-9));
  CHECK(scaled.body().inertia.scaling().limit_before == plain.time_step_limit());
  CHECK(scaled.body().inertia.scaling().limit_after == scaled.time_step_limit());
  CHECK(scaled.time_step_limit() / plain.time_step_limit() == near(1.19, 0.005));
  CHECK(plain.body().inertia.scaling().added == 0);
}

TEST_CASE("a body with added mass falls as any other, keeps its momentum and is stable at its longer step") {
  Setup setup = setup_of(irregular_box(4));
  setup.mass_scaling = 0.05;
  World<double> world(setup);
  State<double> state = world.state();
  state.v = random_displacement(setup.mesh.vertex_count(), 0.01);
  world.set_state(state);
  const auto momentum = [&] {
    Vec3d p = Vec3d::Zero();
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      p += world.body().inertia.mass()[v] * world.state().v.col(v);
    return p;
  };
  const Vec3d before = momentum();
  const double energy = world.energies().total(), dt = 0.9 * world.time_step_limit();
  CHECK(world.time_step_limit() > 1.05 * world.body().inertia.scaling().limit_before);
  for (int i = 0; i < 20000; ++i) world.step(dt);
  CHECK((momentum() - before).norm() < 1e-11 * before.norm());
  CHECK(world.energies().total() < 2 * energy);
  setup.gravity = {0, 0, -9.81};
  World<double> falling(setup);
  for (int i = 0; i < 10; ++i) REQUIRE(falling.advance(0.01).ok);
  const auto z = falling.state().u.row(2);
  CHECK(z.maxCoeff() == near(-0.5 * 9.81 * 0.01, 1e-11));
  CHECK(z.maxCoeff() - z.minCoeff() < 1e-12);
}

TEST_CASE("added mass goes with its vertex when it is cut, and is shared with a copy") {
  Setup setup = setup_of(irregular_box(3));
  setup.mass_scaling = 0.02;
  World<double> world(setup);
  setup.mass_scaling = 0;
  World<double> plain(setup);
  std::vector<double> factor;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    factor.push_back(world.body().inertia.mass()[v] / plain.body().inertia.mass()[v]);
  const auto original = [&](Index v) {  // where a copy is at rest
    Index at = 0;
    (setup.mesh.points.colwise() - Vec3d(plain.elements().points.col(v)))
        .colwise()
        .squaredNorm()
        .minCoeff(&at);
    return std::size_t(at);
  };
  Index copies = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); t += 2) {
    for (World<double>* each : {&world, &plain}) each->remove_tets({t});
    for (Index v = 0; v < Index(plain.body().inertia.mass().size()); ++v) {
      const double expected = factor[original(v)] * plain.body().inertia.mass()[v];
      if (expected > 0)
        CHECK(world.body().inertia.mass()[v] == near(expected, 1e-9));
      else
        CHECK(world.body().inertia.mass()[v] == 0);
    }
    copies = Index(plain.body().inertia.mass().size()) - setup.mesh.vertex_count();
  }
  CHECK(copies > 0);
  CHECK(*std::max_element(factor.begin(), factor.end()) > 1.01);
}
