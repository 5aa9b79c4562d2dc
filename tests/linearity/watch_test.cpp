#include "lobe/linearity/watch.h"

#include <doctest/doctest.h>

#include "fibre_support.h"
#include "liver.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "near.h"
#include "squeezed_bar.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// The left lobe of a liver, all linear, that a grasp leads somewhere in 0.3 s.
Setup grasped_liver(const Vec3d& to, RegionModel model, bool has_fibres = false) {
  Setup setup = held_liver(model);
  if (has_fibres) {
    setup.materials = {fibrous()};
    setup.mesh.fibres = fibrous_setup(setup.mesh).mesh.fibres;
  }
  setup.damping = 20;
  setup.grasps = {{"grasper", left_lobe(setup), {{0, Vec3d::Zero()}, {0.3, to}}, false}};
  return setup;
}

// A blade that cuts the lobe from above, half through, before it is led away.
Setup with_blade(Setup setup) {
  constexpr double wait = 0.2;
  for (PathPoint& row : setup.grasps[0].path) row.time += wait;
  setup.grasps[0].path.insert(setup.grasps[0].path.begin(), {0, Vec3d::Zero()});
  setup.scalpels = {{"blade",
                     0.1,
                     {{0.02, {0.03, -0.09, 0.08}}, {0.18, {0.03, -0.09, 0.02}}},
                     {{0.03, 0.07, 0.08}, {0.03, 0.07, 0.02}}}};
  return setup;
}

double lumped_mass_norm(World<double>& world, const Mat3X<double>& u) {
  double sum = 0;
  for (Index v = 0; v < u.cols(); ++v) sum += lumped_mass(world.elements(), v) * u.col(v).squaredNorm();
  return std::sqrt(sum);
}

struct Played {
  double estimated = 0, measured = 0;  // at the end
  Index moved = 0, copies = 0;
};

Played play(const Setup& setup, LinearityOptions options, double seconds = 0.6) {
  Setup nonlinear = setup;
  std::fill(nonlinear.region_of.begin(), nonlinear.region_of.end(), RegionModel::nonlinear);
  World<double> exact(nonlinear), world(setup);
  LinearityWatch<double> watch(world, {setup.grasps[0].vertices}, std::move(options));
  Played played;
  double largest = 0;
  while (world.time() < seconds - 1e-9) {
    exact.advance(0.02);
    world.advance(0.02);
    const LinearityReport report = watch.look(world);
    played.estimated = report.error;
    played.moved += report.to_nonlinear;
    largest = std::max(largest, lumped_mass_norm(exact, exact.state().u));
  }
  played.copies = world.elements().topology.tet_copy_count();
  REQUIRE(played.copies == exact.elements().topology.tet_copy_count());
  played.measured = lumped_mass_norm(exact, world.state().u - exact.state().u) / largest;
  return played;
}

Played play(const Vec3d& to, LinearityOptions options, double seconds = 0.6, bool has_fibres = false) {
  return play(grasped_liver(to, RegionModel::tensor_mass, has_fibres), std::move(options), seconds);
}

}  // namespace

TEST_CASE("the estimated error is within a factor of two of the measured one") {
  for (const Vec3d& to : {Vec3d(0.004, -0.004, 0.04), Vec3d(0, 0.03, 0), Vec3d(0.02, -0.01, 0.01),
                          Vec3d(0, 0, 0.015), Vec3d(-0.01, 0.01, -0.03)}) {
    CAPTURE(to.transpose());
    const Played played = play(to, {});
    CHECK(played.moved == 0);
    CHECK(played.estimated < 2 * played.measured);
    CHECK(played.estimated > played.measured / 2);
  }
}

TEST_CASE("corrected regions keep the measured error near the tolerance") {
  LinearityOptions options;
  const Vec3d up(0.004, -0.004, 0.04);
  const Played left_alone = play(up, options);
  options.correct = true;
  const Played corrected = play(up, options);
  CHECK(left_alone.measured > 0.04);
  CHECK(corrected.moved > 0);
  CHECK(corrected.measured < 0.03);
}

TEST_CASE("with fibres, too, the error is estimated within a factor of two, and corrected") {
  LinearityOptions options;
  const Vec3d up(0.004, -0.004, 0.04);
  const Played left_alone = play(up, options, 0.6, true);
  CHECK(left_alone.moved == 0);
  CHECK(left_alone.estimated < 2 * left_alone.measured);
  CHECK(left_alone.estimated > left_alone.measured / 2);
  options.correct = true;
  const Played corrected = play(up, options, 0.6, true);
  CHECK(left_alone.measured > 0.04);
  CHECK(corrected.moved > 0);
  CHECK(corrected.measured < 0.03);
}

TEST_CASE("of edge-smoothed tetrahedra the error is estimated within a factor of two, and corrected") {
  const Setup setup = smoothed(grasped_liver(Vec3d(0.004, -0.004, 0.04), RegionModel::tensor_mass));
  LinearityOptions options;
  const Played left_alone = play(setup, options);
  CHECK(left_alone.estimated < 2 * left_alone.measured);
  CHECK(left_alone.estimated > left_alone.measured / 2);
  options.correct = true;
  const Played corrected = play(setup, options);
  CHECK(left_alone.measured > 0.04);
  CHECK(corrected.moved > 0);
  MESSAGE("measured error: " << left_alone.measured << ", corrected " << corrected.measured);
  CHECK(corrected.measured < 0.03);
}

TEST_CASE("who exceeds the tolerance is told, with the place") {
  LinearityOptions options;
  options.tolerance = 0.01;
  int told = 0;
  options.on_exceeded = [&](const LinearityReport& report) {
    ++told;
    CHECK(report.exceeded);
    CHECK(report.error > 0.01);
    CHECK(report.worst > 0);
    CHECK(report.place.x() > -0.02);  // not near the clamp
  };
  play(Vec3d(0.004, -0.004, 0.04), options);
  CHECK(told > 3);
}

TEST_CASE("cuts and corrections in any order: the world equals one built afresh") {
  Setup setup = grasped_liver(Vec3d(0.004, -0.004, 0.04), RegionModel::tensor_mass);
  World<double> world(setup);
  LinearityOptions options;
  options.correct = true;
  LinearityWatch<double> watch(world, {setup.grasps[0].vertices}, options);
  Index moved = 0;
  for (int frame = 0; frame < 30; ++frame) {
    REQUIRE(world.advance(0.02).ok);
    if (frame % 5 == 2) world.remove_tets({37 * frame % setup.mesh.tet_count()});
    const LinearityReport report = watch.look(world);
    moved += report.to_nonlinear + report.to_linear;
    CHECK(std::isfinite(report.error));
  }
  CHECK(moved > 0);
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
}

TEST_CASE(
    "of a body that a blade has cut, too, the error is estimated within a factor of two, and corrected") {
  const Setup setup = with_blade(grasped_liver({0.004, -0.004, 0.04}, RegionModel::tensor_mass));
  LinearityOptions options;
  const Played left_alone = play(setup, options, 0.9);
  CHECK(left_alone.copies > 20);
  CHECK(left_alone.moved == 0);
  CHECK(left_alone.estimated < 2 * left_alone.measured);
  CHECK(left_alone.estimated > left_alone.measured / 2);
  options.correct = true;
  const Played corrected = play(setup, options, 0.9);
  CHECK(left_alone.measured > 0.04);
  CHECK(corrected.moved > 0);
  CHECK(corrected.measured < 0.03);
}

TEST_CASE("a blade, a cautery and corrections in any order: the world equals one built afresh") {
  Setup setup = with_blade(grasped_liver({0.004, -0.004, 0.04}, RegionModel::tensor_mass));
  setup.grasps[0].path.erase(setup.grasps[0].path.begin());
  for (PathPoint& row : setup.grasps[0].path) row.time -= 0.2;  // it is led away while the blade cuts
  World<double> world(setup);
  LinearityOptions options;
  options.correct = true;
  LinearityWatch<double> watch(world, {setup.grasps[0].vertices}, options);
  Index moved = 0;
  for (int frame = 0; frame < 30; ++frame) {
    REQUIRE(world.advance(0.02).ok);
    const Topology& topology = world.elements().topology;
    if (frame % 5 == 2 && topology.tet_copy_count() > 0)
      world.remove_tets({topology.tet_count() - 1 - frame, 37 * frame % setup.mesh.tet_count()});
    const LinearityReport report = watch.look(world);
    moved += report.to_nonlinear + report.to_linear;
    CHECK(std::isfinite(report.error));
    const Zones& zones = watch.zones();
    REQUIRE(static_cast<Index>(zones.of.size()) == topology.tet_count());
    for (Index t = setup.mesh.tet_count(); t < topology.tet_count(); ++t)
      CHECK(zones.of[std::size_t(t)] == zones.of[std::size_t(topology.parent(t))]);
  }
  CHECK(world.elements().topology.tet_copy_count() > 50);
  CHECK(moved > 0);
  CHECK(compare_with_rebuilt(world).largest() < 1e-12);
}

namespace {

// What is far from the grip precomputed; the grip lets go of the lobe in the middle.
Setup condensed_liver(bool expandable) {
  Setup setup = grasped_liver(Vec3d(0.004, -0.004, 0.04), RegionModel::precomputed);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).x() > 0.035) setup.region_of[std::size_t(t)] = RegionModel::nonlinear;
  setup.grasps[0].path.push_back({0.8, setup.grasps[0].path.back().position});
  setup.grasps[0].release = true;
  setup.expandable = expandable;
  return setup;
}

struct Followed {
  double mean = 0, largest = 0;  // error of a frame
  int frames = 0, expanded = 0;
};

Followed follow(bool correct) {
  const Setup setup = condensed_liver(correct);
  Setup nonlinear = setup;
  nonlinear.region_of.assign(nonlinear.region_of.size(), RegionModel::nonlinear);
  World<double> reference(nonlinear), world(setup);
  LinearityOptions options;
  options.correct = correct;
  LinearityWatch<double> watch(world, {setup.grasps[0].vertices}, options);
  watch.look(world);
  Followed followed;
  double largest = 0;
  while (world.time() < 1.2) {
    reference.advance(0.02);
    world.advance(0.02);
    followed.expanded += watch.look(world).is_expanded;
    largest = std::max(largest, lumped_mass_norm(reference, reference.state().u));
    const double error = lumped_mass_norm(reference, world.state().u - reference.state().u) / largest;
    followed.mean += error;
    followed.largest = std::max(followed.largest, error);
    ++followed.frames;
  }
  followed.mean /= followed.frames;
  return followed;
}

}  // namespace

TEST_CASE("a precomputed region that is linearised anew and expanded follows a pull and a release") {
  const Followed alone = follow(false), corrected = follow(true);
  CAPTURE(alone.mean);
  CAPTURE(alone.largest);
  CAPTURE(corrected.mean);
  CAPTURE(corrected.largest);
  CAPTURE(corrected.expanded);
  CHECK(alone.largest > 0.05);
  CHECK(alone.expanded == 0);
  CHECK(corrected.mean < 0.02);
  CHECK(corrected.mean < alone.mean / 2);
  CHECK(corrected.expanded > 5);
  CHECK(corrected.expanded < corrected.frames - 5);
}

TEST_CASE("tetrahedra that are linear until a tangle comes undone are none of its business") {
  World<double> world(squeezed_bar());
  LinearityOptions options;
  options.correct = true;
  LinearityWatch<double> watch(world, {}, options);
  int unravelling = 0, moved = 0;
  for (int i = 0; i < 90; ++i) {
    world.advance(1.0 / 60);
    unravelling += world.is_unravelling();
    const LinearityReport report = watch.look(world);
    if (world.is_unravelling()) moved += report.to_nonlinear + report.to_linear;
  }
  CHECK(unravelling > 20);
  CHECK(moved == 0);
}

TEST_CASE("a cut after the world was put back to fewer edits is followed") {
  const Setup setup = grasped_liver({0.004, -0.004, 0.04}, RegionModel::tensor_mass);
  const std::vector<Index> first{10, 11, 12}, second{300, 301, 302, 303};
  const auto look_after = [&](bool goes_back) {
    World<double> world(setup);
    LinearityWatch<double> watch(world, {setup.grasps[0].vertices}, {});
    for (int i = 0; i < 10; ++i) world.advance(0.02);
    watch.look(world);
    const Checkpoint<double> kept = world.save();
    if (goes_back) {
      world.remove_tets(first);
      watch.look(world);
      world.restore(kept);
    }
    world.remove_tets(second);
    for (int i = 0; i < 3; ++i) {  // what cuts do to zones is found beside the simulation
      watch.look(world);
      world.advance(0.5);
    }
    return watch.look(world).error;
  };
  const double error = look_after(false);
  CHECK(error > 1e-4);
  CHECK(look_after(true) == near(error, 1e-9));
}

TEST_CASE("so is a blade's cut after the world was put back to before another") {
  Setup setup = with_blade(grasped_liver({0.004, -0.004, 0.04}, RegionModel::tensor_mass));
  const auto look_after = [&](bool goes_back) {
    World<double> world(setup);
    LinearityWatch<double> watch(world, {setup.grasps[0].vertices}, {});
    watch.look(world);
    const Checkpoint<double> kept = world.save();
    if (goes_back) {
      const Vec3d tip(0.05, -0.09, 0.08), heel(0.05, 0.07, 0.08);
      const ToolId blade = world.tools().next_id();
      world.apply(BringScalpel{"other", {tip, heel}});
      world.apply(SwitchTool{blade, true});
      world.apply(Lead{blade, {tip - Vec3d(0, 0, 0.06)}});
      for (int i = 0; i < 4; ++i) {
        world.advance(0.02);
        watch.look(world);
      }
      CHECK(world.elements().topology.tet_copy_count() > 20);
      world.restore(kept);
      CHECK(world.elements().topology.tet_copy_count() == 0);
    }
    for (int i = 0; i < 30; ++i) {
      world.advance(0.02);
      watch.look(world);
    }
    CHECK(world.elements().topology.tet_copy_count() > 20);
    for (int i = 0; i < 3; ++i) {  // what cuts do to zones is found beside the simulation
      world.advance(0.5);
      watch.look(world);
    }
    return watch.look(world).error;
  };
  const double error = look_after(false);
  CHECK(error > 1e-4);
  CHECK(look_after(true) == near(error, 1e-9));
}
