#include "lobe/linearity/reduced_watch.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <numeric>

#include "lobe/io/mesh_io.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "reduced_bar.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame = 1.0 / 30;

double norm(const Elements& elements, const Mat3X<double>& u) {  // √Σ m |u|²
  double sum = 0;
  for (Index v = 0; v < u.cols(); ++v) sum += lumped_mass(elements, v) * u.col(v).squaredNorm();
  return std::sqrt(sum);
}

// What a watch says of a world, and what the all-non-linear world says.
struct Watched {
  explicit Watched(const Setup& setup) : world(setup), exact(all_nonlinear(setup)), watch(world, {0.02}) {
    watch.look(world);
  }
  void advance() {
    REQUIRE(world.advance(frame).ok);
    REQUIRE(exact.advance(frame).ok);
    seen = watch.look(world);
    largest = std::max(largest, norm(exact.elements(), exact.state().u));
    error = norm(exact.elements(), world.state().u - exact.state().u) / largest;
  }

  World<double> world, exact;
  ReducedWatch<double> watch;
  ReducedReport seen;
  double error = 0, largest = 0;
};

Setup with_gravity(Setup setup, const Vec3d& gravity) {
  setup.gravity = gravity;
  return setup;
}

// Pulled at its end and aside, and let go.
Setup pulled(Setup setup) {
  setup.guard_below = 0.2;
  const Vec3d end = setup.mesh.points.rowwise().maxCoeff();
  setup.grasps.push_back(
      {"grasp",
       vertices_near(setup.mesh, {end.x(), end.y() / 2, end.z() / 2}, 0.4 * end.z()),
       {{0.05, Vec3d::Zero()}, {0.6, Vec3d(-0.01, 0.02, 0.04)}, {0.8, Vec3d(-0.01, 0.02, 0.04)}},
       true});
  return setup;
}

}  // namespace

TEST_CASE("a body at rest and one that was moved rigidly have no error") {
  Setup setup = damped_bar(12, 4);
  World<double> resting(setup);
  ReducedWatch<double> watch(resting, {0.02});
  for (int i = 0; i < 4; ++i) {
    REQUIRE(resting.advance(frame).ok);
    CHECK(watch.look(resting).error == 0);
  }
  setup.prescribed.clear();
  World<double> moved(setup);
  State<double> state = moved.state();
  const Mat3<double> R = Eigen::AngleAxisd(2, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  state.u = affine_displacement(setup.mesh.points, R);
  moved.set_state(state);
  ReducedWatch<double> of_moved(moved, {0.02});
  for (int i = 0; i < 6; ++i) {
    REQUIRE(moved.advance(frame).ok);
    CHECK(of_moved.look(moved).error < 1e-7);
  }
  CHECK(moved.body().regions.reduced().any_embedded());
}

TEST_CASE("the error does not jump when a lattice takes over, and grows while what is left fades") {
  const Setup setup = with_gravity(damped_bar(12, 4), Vec3d(0, 2, -4));
  World<double> world(setup);
  const Index end = vertices_near(setup.mesh, {0.12, 0.02, 0.02}, 0.012).front();
  world.apply(SetForces{{{end, {0, 0, 0.1}}}});  // a zone around it
  for (int i = 0; i < 30; ++i) REQUIRE(world.advance(frame).ok);
  world.apply(SetForces{{}});
  REQUIRE(world.advance(FullZones::linger + 0.01).ok);  // zones change between frames
  ReducedWatch<double> watch(world, {0.02});
  CHECK(watch.look(world).error == 0);
  const auto& region = world.body().regions.reduced();
  CHECK_FALSE(region.embeds(end));
  world.apply(SetForces{{}});
  CHECK(region.embeds(end));
  const double left =
      norm(world.elements(), region.fading(world.body().motion)) / norm(world.elements(), world.state().u);
  CHECK(left > 2e-5);
  CHECK(watch.look(world).error < 0.1 * left);
  REQUIRE(world.advance(Fading<double>::duration).ok);
  CHECK(region.fading(world.body().motion).norm() == 0);
  CHECK(watch.look(world).error > 0.1 * left);
}

TEST_CASE(
    "in equilibrium the estimated error is the true one up to a factor of 1.5, however large the load is") {
  for (double load : {0.1, 1.0, 4.0}) {
    Watched bent(with_gravity(damped_bar(16, 4), Vec3d(0, 0.5, -1) * load));
    for (int i = 0; i < 60; ++i) bent.advance();
    CAPTURE(load);
    MESSAGE("estimated " << bent.seen.error << ", true " << bent.error);
    CHECK(bent.world.body().regions.reduced().any_embedded());
    CHECK(bent.error > 1e-3);
    CHECK(bent.seen.error > bent.error / 1.5);
    CHECK(bent.seen.error < bent.error * 1.5);
    CHECK(bent.seen.place.x() > 0.08);
  }
}

TEST_CASE("the rotation of a body changes nothing of its estimated error") {
  const Mat3<double> R = Eigen::AngleAxisd(2.5, Vec3d(1, -1, 0.5).normalized()).toRotationMatrix();
  const Vec3d gravity(0, 0.5, -2);
  Setup plain = with_gravity(damped_bar(12, 4), gravity);
  // Held away from rest by next to nothing, so that the same vertices are full.
  for (PrescribedVertex& p : plain.prescribed) p.displacement = Vec3d::Constant(1e-12);
  Setup turned = with_gravity(damped_bar(12, 4), R * gravity);
  turned.ramp = 0;
  for (PrescribedVertex& p : turned.prescribed)  // the whole bar is turned
    p.displacement = (R - Mat3<double>::Identity()) * turned.mesh.points.col(p.vertex);
  World<double> world(plain), other(turned);
  State<double> state = other.state();
  state.u = affine_displacement(turned.mesh.points, R);
  other.set_state(state);
  // What has moved as far is as seldom quick, and so as seldom full.
  Checkpoint<double> moved = world.save();
  moved.nodes.zones.largest = norm(other.elements(), state.u);
  world.restore(moved);
  ReducedWatch<double> watch(world, {0.02}), of_other(other, {0.02});
  double ratio = 0, size = 0, turn = 0;
  for (int i = 0; i < 40; ++i) {
    REQUIRE(world.advance(frame).ok);
    REQUIRE(other.advance(frame).ok);
    size = std::max(size, norm(world.elements(), world.state().u));
    turn = std::max(turn, norm(other.elements(), other.state().u));
    const double error = watch.look(world).error;
    ratio = of_other.look(other).error / error;
  }
  // Errors are relative to the largest √Σ m |u|² so far, which contains the turn.
  CHECK(ratio * turn / size == near(1, 0.2));
}

TEST_CASE("while a bar is pulled and after it is let go the estimate is within a factor of three") {
  for (const Setup& bar :
       {damped_bar(16, 4, 0.01), damped_bar(24, 6, 0.04 / 6), smoothed(damped_bar(24, 6, 0.04 / 6))}) {
    Watched pull(pulled(bar));
    int compared = 0, taken_over = 0;
    double worst = 0, estimated = 0, at_worst = 0;
    while (pull.world.time() < 1.4) {
      const bool was_full = !pull.world.body().regions.reduced().any_embedded();
      pull.advance();
      if (was_full && pull.world.body().regions.reduced().any_embedded() && pull.error > 0.002) {
        ++taken_over;
        CHECK(pull.seen.error > pull.error / 3);
      }
      estimated = std::max(estimated, pull.seen.error);
      if (pull.error > worst) at_worst = pull.seen.error;
      worst = std::max(worst, pull.error);
      if (!(pull.error > 0.007)) continue;
      ++compared;
      CAPTURE(pull.world.time());
      CAPTURE(pull.error);
      CHECK(pull.seen.error > pull.error / 3);
      CHECK(pull.seen.error < pull.error * 3);
    }
    MESSAGE("largest errors: estimated " << estimated << ", true " << worst << ", estimated then "
                                         << at_worst);
    CHECK(compared > 10);
    CHECK(taken_over > 0);
    CHECK(estimated > worst / 2);
    CHECK(estimated < worst * 2);
  }
}

TEST_CASE("the first gestures of the shipped scene, on a liver of 2,000 tetrahedra, have small errors") {
  const Scene scene = read_scene(LOBE_DATA_DIR "/scenes/liver_undeclared.json");
  const TetMesh liver = read_mesh(LOBE_DATA_DIR "/meshes/liver_2k.vtu").mesh;
  Setup setup = resolve(scene, liver, {false}).setup;
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::reduced);
  Watched gesture(setup);
  double largest = 0, estimated = 0, sum = 0, embedded = 0;
  int frames = 0;
  for (; gesture.world.time() < 6; ++frames) {  // all before the cut
    gesture.advance();
    if (gesture.error > largest) estimated = gesture.seen.error;
    largest = std::max(largest, gesture.error);
    sum += gesture.error;
    embedded += region_of(gesture.world).any_embedded();
  }
  MESSAGE("largest error " << largest << ", estimated then " << estimated / largest << " of it, mean "
                           << sum / frames << ", embedded in " << embedded / frames << " of the frames");
  CHECK(embedded > 0.5 * frames);
  CHECK(largest < 0.034);
  CHECK(sum / frames < 0.015);
  CHECK(estimated > 0.6 * largest);
  CHECK(estimated < 1.0 * largest);
}

TEST_CASE_TEMPLATE("a watch changes nothing in a world", Real, float, double) {
  Setup setup = pulled(damped_bar(16, 4));
  setup.gravity = {0, 0, -1};
  World<Real> watched(setup), unwatched(setup);
  ReducedWatch<Real> watch(watched, {0.02});
  for (int i = 0; i < 40; ++i) {
    REQUIRE(watched.advance(frame).ok);
    REQUIRE(unwatched.advance(frame).ok);
    watch.look(watched);
    if (i == 30)
      for (World<Real>* each : {&watched, &unwatched}) each->remove_tets({0, 1, 2, 500, 501});
  }
  CHECK(watch.looking_seconds() > 0);
  CHECK(same_bits(watched, unwatched));
}

TEST_CASE("a body is cut under a watch; its error is estimated again from where it is put back") {
  const Setup setup = with_gravity(damped_bar(16, 4), {0, 0, -2});
  World<double> world(setup);
  ReducedWatch<double> watch(world, {0.02});
  for (int i = 0; i < 30; ++i) {
    REQUIRE(world.advance(frame).ok);
    watch.look(world);
  }
  const Checkpoint<double> before = world.save();
  std::vector<Index> cut;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Vec3d X = barycentre(setup.mesh, t);
    if (std::abs(X.x() - 0.08) < 0.004 && X.z() > 0.015) cut.push_back(t);
  }
  world.remove_tets(cut);
  double after = 0;
  for (int i = 0; i < 40; ++i) {
    REQUIRE(world.advance(frame).ok);
    after = watch.look(world).error;
    CHECK(std::isfinite(after));
  }
  CHECK(after > 0);
  world.restore(before);
  CHECK(watch.look(world).error == 0);
  double again = 0;
  for (int i = 0; i < 40; ++i) {
    REQUIRE(world.advance(frame).ok);
    again = watch.look(world).error;
  }
  // As if nothing had been cut, but for what it has forgotten of the frames before.
  World<double> uncut(setup);
  ReducedWatch<double> of_uncut(uncut, {0.02});
  double error = 0;
  for (int i = 0; i < 70; ++i) {
    REQUIRE(uncut.advance(frame).ok);
    error = of_uncut.look(uncut).error;
  }
  CHECK(again > error / 3);
  CHECK(again < 3 * error);
}

TEST_CASE("a body of two cells along is watched, and one of which everything is cut away") {
  Setup setup = with_gravity(damped_bar(8, 3), {0, 0, -2});
  setup.lattice_cell = 0.039;
  World<double> world(setup);
  ReducedWatch<double> watch(world, {0.02});
  for (int i = 0; i < 40; ++i) {
    REQUIRE(world.advance(frame).ok);
    CHECK(std::isfinite(watch.look(world).error));
    if (i == 8) CHECK(watch.look(world).error > 0);
    if (i != 10) continue;
    std::vector<Index> all(std::size_t(setup.mesh.tet_count()));
    std::iota(all.begin(), all.end(), 0);
    world.remove_tets(all);
  }
}

TEST_CASE("who exceeds the tolerance is told, with the place") {
  World<double> world(with_gravity(damped_bar(16, 4), {0, 0, -2}));
  std::vector<ReducedReport> told;
  ReducedWatch<double> watch(world,
                             {1e-4, false, [&](const ReducedReport& report) { told.push_back(report); }});
  CHECK_FALSE(watch.look(world).exceeded);
  for (int i = 0; i < 20; ++i) {
    REQUIRE(world.advance(frame).ok);
    watch.look(world);
  }
  REQUIRE_FALSE(told.empty());
  CHECK(told.back().exceeded);
  CHECK(told.back().error > 1e-4);
  CHECK(told.back().time == world.time());
}

TEST_CASE("a world without reduced regions has no such error, and pays nothing") {
  World<double> world(all_nonlinear(with_gravity(damped_bar(8, 3), {0, 0, -2})));
  ReducedWatch<double> watch(world, {0.02});
  for (int i = 0; i < 5; ++i) {
    REQUIRE(world.advance(frame).ok);
    CHECK(watch.look(world).error == 0);
  }
  CHECK(watch.looking_seconds() < 1e-3);
}

TEST_CASE("an error above the tolerance is corrected by some of the vertices, which are embedded again") {
  const Setup setup = pulled(damped_bar(24, 6, 0.04 / 6));
  double largest[2] = {0, 0}, most_full = 0;
  for (bool correct : {false, true}) {
    World<double> world(setup), exact(all_nonlinear(setup));
    const double tolerance = 0.012;
    ReducedWatch<double> watch(world, {tolerance, correct});
    watch.look(world);
    Index to_full = 0;
    double size = 0;
    while (world.time() < 3) {
      REQUIRE(world.advance(frame).ok);
      REQUIRE(exact.advance(frame).ok);
      to_full += watch.look(world).to_full;
      size = std::max(size, norm(exact.elements(), exact.state().u));
      const double error = norm(exact.elements(), world.state().u - exact.state().u) / size;
      largest[correct] = std::max(largest[correct], error);
      const auto& region = region_of(world);
      if (correct && region.any_embedded())
        most_full = std::max(most_full, double(region.full_tet_count()) / setup.mesh.tet_count());
    }
    CHECK((to_full > 0) == correct);
    CHECK(region_of(world).full_tet_count() == 216);  // smooth again, but for those at the clamp
  }
  MESSAGE("largest error " << largest[0] << ", corrected " << largest[1] << ", at most " << most_full
                           << " full where not all is");
  CHECK(largest[1] < 0.75 * largest[0]);
}

TEST_CASE("a correction is a list of commands: sent to a world without a watch they have the same bits") {
  Setup setup = with_gravity(damped_bar(16, 4), {0, 0, -3});
  World<float> watched(setup), other(setup, 2);
  ReducedWatch<float> watch(watched, {0.005, true});
  std::vector<Command> sent;
  const CommandSink send = [&](const Command& command) {
    sent.push_back(command);
    watched.apply(command);
  };
  std::size_t done = 0;
  for (int i = 0; i < 40; ++i) {
    watch.look(watched, send);
    for (; done < sent.size(); ++done) other.apply(sent[done]);
    REQUIRE(watched.advance(frame).ok);
    REQUIRE(other.advance(frame).ok);
    CHECK(same_bits(watched, other));
  }
  CHECK(!sent.empty());
  CHECK(std::all_of(sent.begin(), sent.end(),
                    [](const Command& command) { return std::holds_alternative<KeepFull>(command); }));
}
