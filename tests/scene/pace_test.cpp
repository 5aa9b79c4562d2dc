#include "lobe/scene/pace.h"

#include <doctest/doctest.h>

#include <random>

#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A free bar along x whose last cell is `contrast` times as stiff.
Setup bar_with_stiff_end(double contrast, double nu) {
  Setup setup = setup_of(box_mesh({0.12, 0.01, 0.01}, 12, 1, 1));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> jitter(-1e-3, 1e-3);
  for (double& x : setup.mesh.points.reshaped()) x += jitter(random);
  setup.materials.assign(2, seed_material);
  const double E = 5e3 * contrast;
  setup.materials[1].lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  setup.materials[1].mu = E / (2 * (1 + nu));
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) setup.material_of[std::size_t(t)] = t >= 66 ? 1 : 0;
  setup.materials[0].lambda = 5e3 * 0.35 / (1.35 * 0.3);
  setup.materials[0].mu = 5e3 / 2.7;
  return setup;
}

}  // namespace

TEST_CASE("a stiff end sets the pace of a bar, and own steps spare evaluations") {
  Setup setup = bar_with_stiff_end(100, 0.35);
  const std::optional<Pace> pace = pace_at_rest(setup);
  REQUIRE(pace);
  CHECK(pace->time_step == near(World<double>(setup).time_step_limit(), 1e-12));
  CHECK(pace->materials[1] <= 1);
  CHECK(pace->materials[0] >= 3);
  CHECK(pace->evaluations > 1.0 / 12);
  CHECK(pace->evaluations < 0.5);
  setup.own_steps = true;
  World<double> world(setup);
  const double duration = 200 * setup.safety * pace->time_step;
  const Report report = world.advance(duration);
  CHECK(report.steps * world.body().own_steps->share() / 200 == near(pace->evaluations, 0.05));
}

TEST_CASE("both ends of an attachment step as often as the stiffest part") {
  Setup setup = bar_with_stiff_end(100, 0.35);
  const double before = pace_at_rest(setup)->evaluations;
  StrandSetup strand;
  strand.from.tet = 0;
  strand.to.tet = setup.mesh.tet_count() - 1;
  strand.from.weights = strand.to.weights = {0.25, 0.25, 0.25, 0.25};
  strand.stiffness = 1;
  setup.attachments = {{"tie", 1, 3, {strand}}};
  const std::optional<Pace> after = pace_at_rest(setup);
  CHECK((!after || after->evaluations > before));
}

TEST_CASE("no pace is told where own steps do not go, spare little, or nothing moves") {
  const Setup setup = bar_with_stiff_end(100, 0.3);
  CHECK(pace_at_rest(setup));
  Setup selective = setup, implicit = setup, reduced = setup, held = setup, sleeping = setup;
  selective.selective_mass = 3;
  implicit.integrator = Integrator::generalised_alpha;
  reduced.region_of.assign(reduced.region_of.size(), RegionModel::reduced);
  sleeping.sleep = 1e-5;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) held.prescribed.push_back({v, Vec3d::Zero()});
  for (const Setup& none : {selective, implicit, reduced, held, sleeping}) CHECK_FALSE(pace_at_rest(none));
  CHECK_FALSE(pace_at_rest(bar_with_stiff_end(1, 0.35)));
}
