// Reduced bodies that touch themselves.
#include <map>

#include "folder.h"
#include "joined_meshes.h"
#include "lattice_worlds.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double length = 0.1, gap = 0.02;  // [m]

// Two bars in line, the meshes of which do not match; the ends that face each other are `gap` apart.
Setup two_bars(RegionModel model, bool self = true) {
  TetMesh other = box_mesh({length, 0.036, 0.044}, 10, 4, 5);
  other.points.colwise() += Vec3d(length + gap, 0.003, -0.002);
  Setup setup = setup_of(joined(bar(10, 4, false).mesh, other), model);
  setup.lattice_cell = 0.02;
  setup.volume_penalty = 1e5;
  setup.contact.self = self;
  setup.contact.friction = 0.2;
  return setup;
}

// The two of them move towards each other.
struct Collision {
  explicit Collision(const Setup& setup)
      : world(setup), first_of_other(bar(10, 4, false).mesh.vertex_count()) {
    State<double> state = world.state();
    state.v.row(0).head(first_of_other).setConstant(0.05);
    state.v.row(0).tail(state.v.cols() - first_of_other).setConstant(-0.05);
    world.set_state(state);
    energy = world.energies().total();
  }
  // By how far the second bar reaches into the first, along x [m]; below 0: they are apart.
  double overlap() {
    const Mat3X<double> x = world.elements().points.view() + world.state().u;
    return x.row(0).head(first_of_other).maxCoeff() - x.row(0).tail(x.cols() - first_of_other).minCoeff();
  }
  double speed() {  // of the first bar, along x [m/s]
    return world.state().v.row(0).head(first_of_other).mean();
  }
  void advance() {
    REQUIRE(world.advance(0.005).ok);
    const Energies now = world.energies();
    most = std::max(most, now.total());
    deepest = std::max(deepest, overlap());
    if (now.applied == 0) return;
    const auto& region = region_of(world);
    most_touching = std::max(most_touching, now.applied);
    // When they have just met, that is seen at the start of the next frame.
    if (region.any_embedded() && region.full_tet_count() > 0)
      fewest_full = std::min(fewest_full, region.full_tet_count());
  }

  World<double> world;
  Index first_of_other;
  double energy = 0, most = 0, deepest = -1, most_touching = 0;
  Index fewest_full = std::numeric_limits<Index>::max();  // while they touch
};

// Held at both ends, one of which is pressed towards the other; perhaps with a slit through three quarters of
// its middle, whose lips touch.
Setup pressed_along(RegionModel model, bool with_slit, bool self) {
  Setup setup = bar(16, 4, true, model);
  TetMesh& mesh = setup.mesh;
  constexpr double middle = 0.08;
  std::map<Index, Index> copy_of;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.points(0, v) > 2 * middle - edge / 2) setup.prescribed.push_back({v, {-0.004, 0, 0}});
    if (with_slit && std::abs(mesh.points(0, v) - middle) < edge / 2 && mesh.points(2, v) > 1.5 * edge)
      copy_of.emplace(v, mesh.vertex_count() + static_cast<Index>(copy_of.size()));
  }
  mesh.points.conservativeResize(3, mesh.vertex_count() + static_cast<Index>(copy_of.size()));
  for (const auto& [v, copy] : copy_of) mesh.points.col(copy) = mesh.points.col(v);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (barycentre(mesh, t).x() < middle) continue;
    for (Index& v : mesh.tets.col(t))
      if (const auto found = copy_of.find(v); found != copy_of.end()) v = found->second;
  }
  setup.damping = 60;
  setup.contact.self = self;
  setup.contact.friction = 0;
  return setup;
}

double energy_at_rest(const Setup& setup) {
  World<double> world(setup);
  for (int i = 0; i < 25; ++i) REQUIRE(world.advance(0.02).ok);
  if (region_of(world).any()) CHECK(region_of(world).full_tet_count() < 3 * setup.mesh.tet_count() / 4);
  CHECK(region_of(world).pressed_unseen(world.body().motion).empty());
  return world.energies().elastic();
}

}  // namespace

TEST_CASE("reduced bars that collide keep momentum, gain no energy and do not pass through each other") {
  Collision reduced(two_bars(RegionModel::reduced)), exact(two_bars(RegionModel::nonlinear)),
      through(two_bars(RegionModel::reduced, false));
  const auto before = momentum_of(reduced.world);
  for (int i = 0; i < 80; ++i) {
    for (Collision* each : {&reduced, &exact, &through}) each->advance();
    CHECK(region_of(reduced.world).pressed_unseen(reduced.world.body().motion).empty());
    validate(reduced.world);
  }
  const auto after = momentum_of(reduced.world);
  MESSAGE("full while they touch " << reduced.fewest_full << " of "
                                   << reduced.world.elements().topology.tet_count() << ", deepest "
                                   << reduced.deepest << " m, all non-linear " << exact.deepest
                                   << " m; energy " << reduced.most / reduced.energy << ", "
                                   << exact.most / exact.energy << "; afterwards " << reduced.speed() << ", "
                                   << exact.speed() << " m/s");
  CHECK(reduced.fewest_full < 3 * reduced.world.elements().topology.tet_count() / 4);
  CHECK(reduced.most_touching > 0.1 * reduced.energy);
  const double of_one = 0.05 * length * 0.04 * 0.04 * seed_material.density;  // [kg m/s]
  CHECK((after.linear - before.linear).norm() < 1e-12 * of_one);
  CHECK((after.angular - before.angular).norm() < 1e-4 * of_one * 0.04);
  CHECK(reduced.most < 1.05 * reduced.energy);
  CHECK(reduced.deepest == near(exact.deepest, 0.1));
  CHECK(reduced.overlap() < 0);  // they are apart again
  CHECK(reduced.speed() == near(exact.speed(), 0.1));
  CHECK(reduced.speed() < -0.03);
  CHECK(through.deepest > 3 * reduced.deepest);
}

TEST_CASE(
    "a slit in a reduced bar that is pressed shut is as stiff as the bar without it, and without contact it "
    "opens") {
  const double whole = energy_at_rest(pressed_along(RegionModel::reduced, false, false)),
               shut = energy_at_rest(pressed_along(RegionModel::reduced, true, true)),
               loose = energy_at_rest(pressed_along(RegionModel::reduced, true, false)),
               exact = energy_at_rest(pressed_along(RegionModel::nonlinear, true, true)),
               exact_loose = energy_at_rest(pressed_along(RegionModel::nonlinear, true, false));
  MESSAGE("shut " << shut / whole << ", without contact " << loose / whole << ", all non-linear, shut "
                  << exact / whole << ", without " << exact_loose / whole);
  CHECK(shut == near(whole, 0.02));
  CHECK(shut == near(exact, 0.02));
  CHECK(loose == near(exact_loose, 0.02));
  CHECK(loose < 0.9 * whole);
}

TEST_CASE(
    "lips of a reduced bar that press each other have the same bits on any threads and from a checkpoint") {
  const Setup setup = pressed_along(RegionModel::reduced, true, true);
  World<float> world(setup), other(setup, 3), restored(setup, 2);
  const Folder folder;
  for (int i = 0; i < 12; ++i) {
    if (i == 6) {
      write_checkpoint(folder.path / "state", world.save());
      restored.restore(read_checkpoint<float>(folder.path / "state"));
    }
    REQUIRE(world.advance(0.02).ok);
    other.advance(0.02);
    if (i >= 6) restored.advance(0.02);
  }
  CHECK(world.energies().applied > 0);
  CHECK(world.body().regions.reduced().any_embedded());
  CHECK(same_bits(world, other));
  CHECK(same_bits(world, restored));
}
