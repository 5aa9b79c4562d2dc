// Vertices of which a share is held (body/hold_springs.h).
#include "lobe/body/hold_springs.h"

#include <doctest/doctest.h>

#include "lobe/sim/checkpoint.h"
#include "lobe/solve/static_solver.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A block of 3 cm whose lowest vertices are held by shares, the next ones by smaller ones.
Setup partly_held_block(RegionModel model = RegionModel::nonlinear) {
  Setup setup = setup_of(irregular_box(3), model);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const double z = setup.mesh.points(2, v);
    if (z < 0.003) setup.partly_held.push_back({v, 0.9, Vec3d(0.001, 0, 0)});
    if (z > 0.005 && z < 0.013)
      setup.partly_held.push_back({v, 0.3, Vec3d(0.001, 0, 0), {true, false, true}});
  }
  return setup;
}

Setup grasped_block() {
  Setup setup = partly_held_block();
  GraspSetup grasp{"forceps", {}, {{0, Vec3d::Zero()}, {0.05, Vec3d(0, 0.002, 0.001)}}};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const double z = setup.mesh.points(2, v);
    if (z < 0.017) continue;
    grasp.vertices.push_back(v);
    grasp.shares.push_back(z > 0.027 ? 1 : 0.4);
  }
  setup.grasps.push_back(grasp);
  setup.damping = 60;
  return setup;
}

Mat3X<double> shaken(Index vertices) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> component(-0.01, 0.01);
  Mat3X<double> v(3, vertices);
  for (double& x : v.reshaped()) x = component(random);
  return v;
}

}  // namespace

TEST_CASE("the step does not see springs of partly held vertices") {
  Setup setup = partly_held_block();
  World<double> held(setup);
  setup.partly_held.clear();
  World<double> free(setup);
  CHECK(held.time_step_limit() == free.time_step_limit());
}

// ½ v⁻·(M + k Δt²/4) v⁺ + U, with springs of up to 99 times the vertex's own stiffness.
TEST_CASE("a linear body on such springs conserves its energy at the limit of the step") {
  Setup setup = partly_held_block(RegionModel::tensor_mass);
  for (PartlyHeldVertex& p : setup.partly_held) p.share = p.share > 0.5 ? 0.99 : 0.3;
  setup.ramp = 0;
  World<double> world(setup);
  State<double> state = world.state();
  state.v = shaken(setup.mesh.vertex_count());
  world.set_state(state);
  const double dt = 0.99 * world.time_step_limit();
  const auto energy = [&] {
    const Mat3X<double> before = world.state().v;
    const Energies e = world.energies();
    world.step(dt);
    Mat3X<double> masses(3, before.cols());
    for (Index v = 0; v < before.cols(); ++v)
      masses.col(v).setConstant(world.body().inertia.mass()[std::size_t(v)]);
    for (const auto& spring : world.body().hold_springs.all())
      for (int i = 0; i < 3; ++i)
        if (spring.item.axes[i]) masses(i, spring.item.vertex) += spring.stiffness * dt * dt / 4;
    const Mat3X<double> after = world.state().v;
    return before.cwiseProduct(masses).cwiseProduct(after).sum() / 2 + e.total() - e.kinetic;
  };
  world.step(dt);
  const double start = energy();
  for (int i = 0; i < 300; ++i) REQUIRE(energy() == near(start, 1e-9));
}

TEST_CASE("a body in motion comes to rest in its static equilibrium") {
  Setup setup = partly_held_block();
  setup.gravity = {0, 0, -9.81};
  setup.damping = 60;
  const StaticResult equilibrium = solve_static(setup);
  REQUIRE(equilibrium.converged);
  World<double> world(setup);
  REQUIRE(world.advance(1.2).ok);
  const Mat3X<double> u = world.state().u;
  CHECK((u - equilibrium.u).norm() < 1e-6 * equilibrium.u.norm());
  CHECK(u.colwise().norm().maxCoeff() > 0.001);
}

TEST_CASE("springs bear the weight of the body") {
  Setup setup = partly_held_block();
  setup.gravity = {0, 0, -9.81};
  const StaticResult equilibrium = solve_static(setup);
  REQUIRE(equilibrium.converged);
  const double weight = 9.81 * 1000 * total_volume(setup.mesh);
  CHECK(equilibrium.reactions.rowwise().sum().z() == near(weight, 1e-9));
}

TEST_CASE("the stiffness of a share grows from none to that of what is held") {
  Setup setup = partly_held_block();
  setup.gravity = {0, 0, -9.81};
  const auto solved = [&](double share) {
    for (PartlyHeldVertex& p : setup.partly_held) p.share = share;
    return solve_static(setup).u;
  };
  Setup wholly = setup;
  wholly.partly_held.clear();
  for (const PartlyHeldVertex& p : setup.partly_held)
    wholly.prescribed.push_back({p.vertex, p.displacement, p.axes});
  const Mat3X<double> limit = solve_static(wholly).u;
  const double close = (solved(0.99) - limit).norm(), closer = (solved(0.999) - limit).norm();
  CHECK(close < 0.01 * limit.norm());
  CHECK(closer == near(close / 10, 0.1));
}

TEST_CASE("a grasp by shares bears what its springs pull") {
  World<double> world(grasped_block());
  for (const double frame : {0.9, 0.01}) REQUIRE(world.advance(frame).ok);  // its force is the mean of one
  const HeldVertices& held = world.held();
  CHECK(held.partly().size() == world.body().hold_springs.all().size());
  const Vec3d by_grasp =
      world.tools().placed(world.time(), held, [](Index) { return Vec3d::Zero(); }).front().force;
  Vec3d by_boundary = Vec3d::Zero();
  for (const auto& spring : world.body().hold_springs.all())
    if (spring.item.holder == HeldVertices::boundary) by_boundary += spring.force;
  CHECK(by_grasp.norm() > 0.01);
  CHECK((by_grasp + by_boundary).norm() < 1e-5 * by_grasp.norm());  // at rest
}

TEST_CASE("a grasp by shares lets go of all of them") {
  Setup setup = grasped_block();
  setup.grasps[0].release = true;
  World<double> world(setup);
  world.advance(0.04);
  CHECK(world.held().partly().size() > setup.partly_held.size());
  world.advance(0.04);
  CHECK(world.held().partly().size() == setup.partly_held.size());
  CHECK(fault_of(world) == "");
}

TEST_CASE_TEMPLATE("a restored world goes on with the same bits", Real, float, double) {
  World<Real> world(grasped_block()), restored(grasped_block(), 2);
  for (int i = 0; i < 4; ++i) world.advance(0.01);
  restored.restore(parse_checkpoint<Real>("kept", checkpoint_bytes(world.save())));
  for (int i = 0; i < 4; ++i) {
    world.advance(0.01);
    restored.advance(0.01);
  }
  CHECK(same_bits(world, restored));
}

TEST_CASE("after a cut springs are as stiff as those of a body built anew") {
  Setup setup = grasped_block();
  World<double> world(setup);
  world.advance(0.02);
  std::vector<Index> corner;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).x() < 0.012 && barycentre(setup.mesh, t).y() < 0.012) corner.push_back(t);
  world.remove_tets(corner);
  world.advance(0.01);
  CHECK(fault_of(world) == "");
  CompactMesh compacted;
  const Setup cut = world.current_setup(compacted);
  const Elements anew(cut);
  std::size_t there = 0;
  for (const auto& spring : world.body().hold_springs.all()) {
    const Index v = compacted.vertex_target[spring.item.vertex];
    if (v < 0) {
      CHECK(spring.stiffness == 0);
      continue;
    }
    ++there;
    HeldVertices::Held item = spring.item;
    item.vertex = v;
    CHECK(spring.stiffness == near(hold_stiffness(anew, item), 1e-12));
  }
  CHECK(cut.partly_held.size() == there);
}

TEST_CASE("a copy of a partly held vertex is held by the same share") {
  HeldVertices held;
  held.hold({3, HeldVertices::boundary, Vec3d::Zero(), Vec3d::Zero(), all_axes, 0.4});
  held.hold({3, 5, Vec3d::Zero(), Vec3d::Zero(), all_axes, 0.7});
  held.split(3, 9);
  REQUIRE(held.partly().size() == 4);
  CHECK(held.anchors(9));
  CHECK_FALSE(held.holds(9));
  CHECK(held.partly()[3].vertex == 9);
  CHECK(held.partly()[3].share == 0.7);
  held.release(5);
  CHECK(held.partly().size() == 2);
  CHECK(HeldVertices::from_saved(held.as_saved()) == held);
  held.free(3);
  CHECK_FALSE(held.anchors(3));
  held.free(9);
  CHECK(held.partly().empty());
}
