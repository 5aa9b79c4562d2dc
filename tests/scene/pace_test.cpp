#include "lobe/scene/pace.h"

#include <doctest/doctest.h>

#include <numeric>
#include <random>

#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A free bar along x whose last cells are `contrast` times as stiff.
Setup bar_with_stiff_end(double contrast, double nu) {
  Setup setup = setup_of(box_mesh({0.06, 0.01, 0.01}, 6, 1, 1));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> jitter(-1e-3, 1e-3);
  for (double& x : setup.mesh.points.reshaped()) x += jitter(random);
  setup.materials.assign(2, seed_material);
  const double E = 5e3 * contrast;
  setup.materials[1].lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  setup.materials[1].mu = E / (2 * (1 + nu));
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) setup.material_of[std::size_t(t)] = t >= 30 ? 1 : 0;
  setup.materials[0].lambda = 5e3 * 0.35 / (1.35 * 0.3);
  setup.materials[0].mu = 5e3 / 2.7;
  return setup;
}

}  // namespace

TEST_CASE("a stiff end sets the pace of a bar, and its own steps would spare evaluations") {
  const Setup setup = bar_with_stiff_end(100, 0.35);
  const std::optional<Pace> pace = pace_at_rest(setup);
  REQUIRE(pace);
  CHECK(pace->time_step == near(World<double>(setup).time_step_limit(), 1e-12));
  CHECK(pace->materials[1].lowest == 0);
  CHECK(pace->materials[1].highest <= 1);
  CHECK(pace->materials[0].lowest == 0);  // it shares vertices with the stiff end
  CHECK(pace->materials[0].highest == 3);
  CHECK(std::accumulate(pace->tets_of_level.begin(), pace->tets_of_level.end(), 0) == setup.mesh.tet_count());
  double share = 0;
  for (Level l = 0; l <= highest_level; ++l) share += pace->tets_of_level[l] / double(1 << l);
  CHECK(pace->by_tets == near(share / setup.mesh.tet_count(), 1e-14));
  CHECK(pace->by_patches == 1);  // both patches have vertices of the stiff end
}

TEST_CASE("an attachment makes both of its ends step with the faster one") {
  Setup setup = bar_with_stiff_end(100, 0.35);
  const double before = pace_at_rest(setup)->by_tets;
  StrandSetup strand;
  strand.from.tet = 0;
  strand.to.tet = setup.mesh.tet_count() - 1;
  setup.attachments = {{"tie", 1, 3, {strand}}};
  const Pace after = *pace_at_rest(setup);
  CHECK(after.by_tets > before);
  CHECK(after.materials[0].highest == 2);
}

TEST_CASE("no pace is told where steps are not those of single vertices, or nothing moves") {
  Setup setup = bar_with_stiff_end(10, 0.3);
  CHECK(pace_at_rest(setup));
  Setup selective = setup, implicit = setup, reduced = setup, held = setup;
  selective.selective_mass = 3;
  implicit.integrator = Integrator::generalised_alpha;
  reduced.region_of.assign(reduced.region_of.size(), RegionModel::reduced);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) held.prescribed.push_back({v, Vec3d::Zero()});
  for (const Setup& none : {selective, implicit, reduced, held}) CHECK_FALSE(pace_at_rest(none));
}
