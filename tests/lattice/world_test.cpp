// Worlds with reduced regions.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "folder.h"
#include "lattice_worlds.h"
#include "lobe/error.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// The same size of six cells across.
Setup fine_bar() {
  Setup setup = bar(24, 6);
  setup.mesh.points *= 2.0 / 3;
  return setup;
}

// ½ v⁻·M v⁺ + U(u), over a step of dt [J].
double staggered(World<double>& world, double dt) {
  const auto& motion = world.body().motion;
  const Mat3X<double> v = motion.v.view(), w = motion.nodes.v;
  const Energies e = world.energies();
  world.step(dt);
  double twice = 0;
  for (Index i = 0; i < v.cols(); ++i)
    if (!world.body().regions.reduced().embeds(i))
      twice += world.body().inertia.mass()[std::size_t(i)] * v.col(i).dot(motion.v.col(i));
  for (Index n = 0; n < w.cols(); ++n)
    twice += region_of(world).embedding().mass[std::size_t(n)] * w.col(n).dot(motion.nodes.v.col(n));
  return twice / 2 + e.total() - e.kinetic;
}

// Thrown, turning and swinging.
World<double> thrown(const Setup& setup, int threads = 1) {
  World<double> world(setup, threads);
  State<double> state = world.state();
  for (Index v = 0; v < state.v.cols(); ++v) {
    const Vec3d X = setup.mesh.points.col(v);
    state.v.col(v) =
        Vec3d(0.1, -0.2, 0.3) + Vec3d(1, 2, -3).cross(X) + Vec3d(0, std::sin(30 * X.x()), 5 * X.y());
  }
  world.set_state(state);
  return world;
}

std::string refusal(const Setup& setup) {
  try {
    World<float> world(setup);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE(
    "where every vertex is displaced or next to one, a reduced region moves as a non-linear one, to the "
    "bit") {
  Setup setup = bar(4, 4, false);
  setup.gravity = {0, 3, -9.81};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const double x = setup.mesh.points(0, v) / edge;
    if (x < 0.5 || (x > 1.5 && x < 2.5) || x > 3.5) setup.prescribed.push_back({v, {0, 1e-4, 0}});
  }
  World<double> reduced(setup), exact(all_nonlinear(setup));
  CHECK_FALSE(region_of(reduced).any_embedded());
  for (int i = 0; i < 10; ++i) {
    reduced.advance(0.02);
    exact.advance(0.02);
    CHECK(same_bits(reduced, exact));
  }
  CHECK(exact.state().u.norm() > 0);
}

TEST_CASE("mass that is added where a lattice moves the body goes with it, and keeps the step") {
  Setup setup = pulled_bar();
  World<double> world(setup);
  const double weight = world.elements().materials[0].density * total_volume(setup.mesh);
  double full = 0, embedded = 0;
  for (int i = 0; i < 40; ++i) {
    const double limit = world.advance(0.02).time_step_limit;
    const bool any = region_of(world).any_embedded();
    (any ? embedded : full) = limit;
    double sum = 0;
    for (double m : world.body().inertia.mass()) sum += m;
    for (double m : region_of(world).embedding().mass) sum += m;
    CHECK(sum == near(weight + region_of(world).mass_added(), 1e-12));
    if (!any) CHECK(region_of(world).mass_added() == 0);
  }
  MESSAGE("steps of " << full << " s; with a lattice " << embedded << " s, mass added "
                      << region_of(world).mass_added() / weight);
  CHECK(embedded > 0.8 * full);
  CHECK(region_of(world).mass_added() < 0.3 * weight);
}

TEST_CASE("a thrown reduced body keeps its momentum and its energy over thousands of undamped steps") {
  World<double> world = thrown(bar(12, 4, false));
  CHECK(region_of(world).full_tet_count() == 0);
  const double dt = 0.8 * world.time_step_limit();
  world.step(dt);
  const auto before = momentum_of(world);
  const double start = staggered(world, dt);
  double largest = 0;
  for (int i = 0; i < 20000; ++i)
    if (i % 100 == 0)
      largest = std::max(largest, std::abs(staggered(world, dt) - start));
    else
      world.step(dt);
  const auto change = momentum_of(world) - before;
  MESSAGE("relative change of energy " << largest / start << ", of momentum "
                                       << change.linear.norm() / before.linear.norm() << ", "
                                       << change.angular.norm() / before.angular.norm());
  CHECK(largest < 0.02 * start);
  CHECK(change.linear.norm() < 1e-9 * before.linear.norm());
  CHECK(change.angular.norm() < 1e-9 * before.angular.norm());
  CHECK(world.state().u.norm() > 0.1);
}

TEST_CASE(
    "a full zone with masses of its own beside a lattice: over a million undamped steps energy neither grows "
    "nor decays") {
  const Setup setup = bar(8, 2);
  World<double> world(setup);
  const Index end = vertices_near(setup.mesh, {0.08, 0.01, 0.01}, 0.008).front();
  world.apply(SetForces{{{end, Vec3d::Zero()}}});  // a zone around it, and no force
  State<double> state = world.state();
  for (Index v = 0; v < state.v.cols(); ++v) {
    const double x = setup.mesh.points(0, v);
    if (x > edge / 2) state.v.col(v) = Vec3d(0, 2 * x, x);
  }
  world.set_state(state);
  REQUIRE(region_of(world).any_embedded());
  REQUIRE_FALSE(region_of(world).embeds(end));
  const double dt = 0.9 * world.time_step_limit();
  for (int i = 0; i < 1000; ++i) world.step(dt);
  const auto mean_energy = [&] {  // of the next 1000 steps
    double sum = 0;
    for (int i = 0; i < 1000; ++i)
      if (i % 10 == 0)
        sum += staggered(world, dt);
      else
        world.step(dt);
    return sum / 100;
  };
  const double start = mean_energy();
  double least = start, most = start;
  for (int i = 0; i < 1000; ++i) {
    const double now = mean_energy();
    least = std::min(least, now);
    most = std::max(most, now);
  }
  const double last = mean_energy();
  MESSAGE("of the energy at the start " << least / start << " to " << most / start << ", at the end "
                                        << last / start << "; mass added " << region_of(world).mass_added());
  CHECK(region_of(world).mass_added() > 0);
  CHECK(most < 1.02 * start);
  CHECK(least > 0.98 * start);
}

TEST_CASE("zones that become full and are embedded again keep linear and angular momentum") {
  Setup setup = bar(16, 4, false);
  World<double> world = thrown(setup);
  const auto before = momentum_of(world);
  const Energies first = world.energies();
  const Index v = vertices_near(setup.mesh, {0.16, 0.02, 0.02}, 0.012).front();
  Index most = 0, least = setup.mesh.tet_count();
  double reported = 0;
  for (int i = 0; i < 40; ++i) {                                // it is quick at first
    if (i == 10) world.apply(SetForces{{{v, Vec3d::Zero()}}});  // is touched, and nothing else
    if (i == 18) world.apply(SetForces{{}});
    const Report report = world.advance(0.02);
    REQUIRE(report.ok);
    reported += report.transitions.total() / first.total();
    validate(world);
    if (i >= 10 && i < 18) {
      CHECK_FALSE(world.body().regions.reduced().embeds(v));
      CHECK(region_of(world).full_tet_count() < setup.mesh.tet_count());
    }
    most = std::max(most, region_of(world).full_tet_count());
    least = std::min(least, region_of(world).full_tet_count());
    const auto change = momentum_of(world) - before;
    CHECK(change.linear.norm() < 1e-9 * before.linear.norm());
    CHECK(change.angular.norm() < 1e-9 * before.angular.norm());
  }
  CHECK(most == setup.mesh.tet_count());
  CHECK(least == 0);
  const double change = world.energies().total() / first.total() - 1;
  MESSAGE("energy that three transitions cost: " << change << ", reported: " << reported);
  CHECK(std::abs(change) < 0.1);
  CHECK(std::abs(change - reported) < 0.02);
}

TEST_CASE("a reduced bar bends and swings as a non-linear one, of plain and of edge-smoothed tetrahedra") {
  for (const Setup& bar : {fine_bar(), smoothed(fine_bar())}) {
    Setup setup = bar;
    setup.gravity = {0, 0, -3};
    setup.damping = 5;
    World<double> reduced(setup), exact(all_nonlinear(setup));
    double largest = 0, top = 0;
    for (int i = 0; i < 30; ++i) {
      REQUIRE(reduced.advance(0.02).ok);
      REQUIRE(exact.advance(0.02).ok);
      top = std::max(top, exact.state().u.norm());
      largest = std::max(largest, (reduced.state().u - exact.state().u).norm());
    }
    const double tip = reduced.state().u.row(2).minCoeff() / exact.state().u.row(2).minCoeff();
    MESSAGE("largest error " << largest / top << ", tip at the end " << tip);
    CHECK(largest < (setup.materials[0].is_smoothed() ? 0.16 : 0.1) * top);  // its lowest modes are too quick
    CHECK(region_of(reduced).any_embedded());
  }
}

TEST_CASE("a reduced region shares vertices with any other, of plain and of edge-smoothed tetrahedra") {
  for (const auto& [other, is_smoothed] : {std::pair{RegionModel::nonlinear, false},
                                           {RegionModel::tensor_mass, false},
                                           {RegionModel::precomputed, false},
                                           {RegionModel::nonlinear, true},
                                           {RegionModel::tensor_mass, true},
                                           {RegionModel::precomputed, true}}) {
    Setup setup = is_smoothed ? smoothed(bar(16, 4)) : bar(16, 4);
    setup.gravity = {0, 0, -0.5};
    setup.damping = 20;
    for (Index t = 0; t < setup.mesh.tet_count(); ++t)
      if (barycentre(setup.mesh, t).x() < 0.05) setup.region_of[std::size_t(t)] = other;
    Setup compared = setup;
    for (RegionModel& model : compared.region_of)
      if (model == RegionModel::reduced) model = RegionModel::nonlinear;
    World<double> reduced(setup), exact(compared);
    for (int i = 0; i < 20; ++i) {
      REQUIRE(reduced.advance(0.03).ok);
      REQUIRE(exact.advance(0.03).ok);
    }
    validate(reduced);
    CAPTURE(std::string(name(other)));
    const double error = relative_error(reduced.state().u, exact.state().u);
    MESSAGE(std::string(name(other)) << ": " << error);
    CHECK(error < 0.06);
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)  // held and shared ones move by themselves
      if (setup.mesh.points(0, v) < 0.055) CHECK_FALSE(reduced.body().regions.reduced().embeds(v));
  }
}

TEST_CASE("dead loads and gravity act on what follows a lattice, and grow as they are told") {
  Setup setup = fine_bar();
  setup.gravity = {0, 0, -0.5};
  setup.load_ramp = 0.3;
  setup.damping = 30;
  setup.vertex_loads.push_back({vertices_near(setup.mesh, {0.16, 0.02, 0.02}, 0.01).front(), {0, 0.01, 0}});
  World<double> reduced(setup), exact(all_nonlinear(setup));
  for (int i = 0; i < 40; ++i) {
    reduced.advance(0.05);
    exact.advance(0.05);
  }
  CHECK(relative_error(reduced.state().u, exact.state().u) < 0.06);
  CHECK(reduced.energies().loads == near(exact.energies().loads, 0.06));
}

TEST_CASE("a gesture on a reduced bar: steps of the limit suffice where a lattice moves it") {
  Setup setup = pulled_bar();
  World<double> world(setup), exact(pulled_bar(RegionModel::nonlinear));
  double top = 0, largest = 0, ratio = 1;
  int reruns = 0;
  for (int i = 0; i < 40; ++i) {
    const Report report = world.advance(0.02);
    exact.advance(0.02);
    ratio = std::min(ratio, world.step_limit().ratios().of_nodes);
    REQUIRE(report.ok);
    validate(world);
    // Tetrahedra that were just freed swing at their highest frequency: such a frame may be run again.
    if (world.body().regions.reduced().any_embedded()) reruns += report.reruns;
    top = std::max(top, exact.state().u.norm());
    largest = std::max(largest, (world.state().u - exact.state().u).norm());
    for (const PrescribedVertex& prescribed : setup.prescribed)
      CHECK(world.state().u.col(prescribed.vertex).isZero(0));
    if (i == 10)
      for (Index v : setup.grasps[0].vertices)
        CHECK((world.state().u.col(v) - exact.state().u.col(v)).norm() < 1e-9);
  }
  CHECK(reruns == 0);
  CHECK(ratio < 0.95);  // steps are longer than bounds of nodes allow
  MESSAGE("largest error " << largest / top);
  CHECK(largest < 0.1 * top);
}

TEST_CASE_TEMPLATE("a reduced world goes on with the same bits after it was restored, on any threads", Real,
                   float, double) {
  const Setup setup = pulled_bar();
  World<Real> world(setup), two(setup, 2), seven(setup, 7);
  const Folder folder;
  for (int i = 0; i < 26; ++i) {
    for (World<Real>* each : {&world, &two, &seven}) REQUIRE(each->advance(0.02).ok);
    CHECK(same_bits(world, two));
    CHECK(same_bits(world, seven));
    if (i % 5 != 3) continue;
    write_checkpoint(folder.path / "state", world.save());
    World<Real> restored(setup, 2);
    restored.restore(read_checkpoint<Real>(folder.path / "state"));
    CHECK(same_bits(world, restored));
    two = std::move(restored);
  }
  const Checkpoint<Real> early = read_checkpoint<Real>(folder.path / "state");
  world.restore(early);
  CHECK(world.state().u == early.state.u);
}

TEST_CASE("to read the state of a reduced world changes nothing") {
  const Setup setup = pulled_bar();
  World<float> read(setup), unread(setup);
  for (int i = 0; i < 26; ++i)
    for (World<float>* each : {&read, &unread}) {
      REQUIRE(each->advance(0.02).ok);
      read.state();
    }
  CHECK(same_bits(read, unread));
}

TEST_CASE("a cautery and commands cut through a reduced region") {
  Setup setup = bar(16, 4);
  setup.gravity = {0, 0, -2};
  setup.damping = 10;
  setup.cauteries.push_back(
      {"cautery", 0.004, {{0.1, Vec3d(0.08, -0.01, 0.035)}, {0.5, Vec3d(0.08, 0.03, 0.025)}}});
  World<double> world(setup), exact(all_nonlinear(setup));
  Index removed = 0;
  for (int i = 0; i < 30; ++i) {
    const Report report = world.advance(0.02);
    exact.advance(0.02);
    REQUIRE(report.ok);
    removed += report.tets_removed;
    validate(world);
  }
  CHECK(removed > 10);
  const double error = relative_error(world.state().u.leftCols(setup.mesh.vertex_count()),
                                      exact.state().u.leftCols(setup.mesh.vertex_count()));
  MESSAGE("error after a cut " << error);
  CHECK(error < 0.15);
  const Checkpoint<double> kept = world.save();
  World<double> restored(setup);
  restored.restore(kept);
  for (int i = 0; i < 5; ++i) {
    world.advance(0.02);
    restored.advance(0.02);
    CHECK(same_bits(world, restored));
  }
}

TEST_CASE("tetrahedra become reduced and non-linear while a world runs") {
  Setup setup = bar(16, 4, true, RegionModel::nonlinear);
  setup.gravity = {0, 0, -2};
  setup.damping = 10;
  World<double> world(setup);
  for (int i = 0; i < 10; ++i) world.advance(0.02);
  std::vector<Index> all(std::size_t(setup.mesh.tet_count()));
  std::iota(all.begin(), all.end(), 0);
  const Mat3X<double> before = world.state().u;
  world.apply(SetRegion{all, RegionModel::reduced});
  validate(world);
  CHECK(region_of(world).any_embedded());
  const double jump = relative_error(world.state().u, before);
  MESSAGE("jump " << jump);
  CHECK(jump < 8e-7);
  for (int i = 0; i < 5; ++i) REQUIRE(world.advance(0.02).ok);
  const Mat3X<double> embedded = world.state().u;
  world.apply(SetRegion{all, RegionModel::nonlinear});
  CHECK(relative_error(world.state().u, embedded) < 1e-15);
  CHECK_FALSE(region_of(world).any());
  for (int i = 0; i < 5; ++i) REQUIRE(world.advance(0.02).ok);
  validate(world);
}

TEST_CASE_TEMPLATE("odd bodies move and are cut to nothing, and every number stays finite", Real, float,
                   double) {
  const auto thin = [] {  // half a cell
    TetMesh mesh = box_mesh({0.16, 0.08, 0.01}, 16, 8, 1);
    Setup setup = setup_of(mesh, RegionModel::reduced);
    setup.lattice_cell = 2 * edge;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.points(0, v) < edge / 2) setup.prescribed.push_back({v, Vec3d::Zero()});
    return setup;
  };
  const auto two_materials = [] {  // in each cell, stiffer by a hundred times
    Setup setup = bar(8, 4);
    setup.materials.push_back(setup.materials[0]);
    setup.materials[1].lambda *= 100;
    setup.materials[1].mu *= 100;
    for (std::size_t t = 0; t < setup.material_of.size(); ++t) setup.material_of[t] = std::uint16_t(t % 2);
    return setup;
  };
  const auto two_pieces = [] {  // a hair apart, in the same cells
    const TetMesh one = box_mesh({0.16, 0.019, 0.04}, 16, 2, 4);
    const Index count = one.vertex_count();
    TetMesh mesh = one;
    mesh.points.resize(3, 2 * count);
    mesh.points << one.points, one.points.colwise() + Vec3d(0, 0.0195, 0);
    mesh.tets.resize(4, 2 * one.tet_count());
    mesh.tets << one.tets, (one.tets.array() + count).matrix();
    mesh.labels.assign(std::size_t(mesh.tet_count()), 0);
    Setup setup = setup_of(mesh, RegionModel::reduced);
    setup.lattice_cell = 2 * edge;
    for (Index v = 0; v < count; ++v)  // the other one falls
      if (mesh.points(0, v) < edge / 2) setup.prescribed.push_back({v, Vec3d::Zero()});
    return setup;
  };
  const std::vector<std::pair<const char*, Setup>> bodies = {{"thin", thin()},
                                                             {"two materials", two_materials()},
                                                             {"two pieces", two_pieces()},
                                                             {"nothing held", bar(12, 4, false)}};
  for (const auto& [body, shape] : bodies) {
    CAPTURE(std::string(body));
    Setup setup = shape;
    setup.gravity = {0, 0, -1};
    setup.damping = 10;
    World<Real> world(setup);
    const LatticeRegion<Real>& region = world.body().regions.reduced();
    CHECK(region.any_embedded());
    for (int i = 0; i < 15; ++i) {
      REQUIRE(world.advance(0.02).ok);
      CHECK(world.state().u.allFinite());
      CHECK(world.state().u.norm() > 0);
    }
    validate(world);
    std::mt19937 random(3);
    for (Index left = setup.mesh.tet_count(); left > 0;) {  // everything cut
      std::vector<Index> tets;
      for (Index t = 0; t < setup.mesh.tet_count(); ++t)
        if (world.elements().topology.alive(t) && (left < 60 || random() % 4 == 0)) tets.push_back(t);
      world.apply(RemoveTets{tets});
      validate(world);
      REQUIRE(world.advance(0.02).ok);
      CHECK(world.state().u.allFinite());
      left = 0;
      for (Index t = 0; t < setup.mesh.tet_count(); ++t) left += world.elements().topology.alive(t);
    }
    CHECK_FALSE(region.any());
  }
}

TEST_CASE("what does not go with a reduced region, or does not suit it, is named") {
  Setup setup = bar(8, 4);
  CHECK(refusal(setup) == "");
  const auto with = [&](auto change) {
    Setup other = setup;
    change(other);
    return refusal(other);
  };
  CHECK(with([](Setup& s) { s.selective_mass = 3; }).find("\"selective_mass\"") != std::string::npos);
  CHECK(with([](Setup& s) { s.sleep = 1e-5; }).find("\"sleep\"") != std::string::npos);
  CHECK(with([](Setup& s) { s.lattice_cell = 0.005; }).find("hardly larger than the tetrahedra") !=
        std::string::npos);
  CHECK(with([](Setup& s) { s.lattice_cell = 1; }).find("more than half of the reduced regions") !=
        std::string::npos);
  CHECK(with([](Setup& s) { s.lattice_cell = -1; }).find("lattice_cell") != std::string::npos);
}

TEST_CASE("vertices are kept full for a while by command; a checkpoint knows it, and nothing jumps") {
  Setup setup = bar(16, 4);
  setup.damping = 20;
  setup.gravity = {0, 0, -0.05};
  World<double> world(setup);
  for (int i = 0; i < 50; ++i) REQUIRE(world.advance(0.02).ok);
  const std::vector<Index> end = vertices_near(setup.mesh, {0.16, 0.02, 0.02}, 0.03);
  const Index before = region_of(world).full_tet_count();
  const Mat3X<double> u = world.state().u;
  world.apply(KeepFull{end, 0.15});
  CHECK(world.state().u == u);
  REQUIRE(world.advance(0.02).ok);
  for (Index v : end) CHECK_FALSE(region_of(world).embeds(v));
  CHECK(region_of(world).full_tet_count() > before);
  CHECK(region_of(world).any_embedded());
  World<double> restored(setup, 2);
  restored.restore(world.save());
  Mat3X<double> last = world.state().u;
  for (int i = 0; i < 15; ++i) {
    REQUIRE(world.advance(0.02).ok);
    REQUIRE(restored.advance(0.02).ok);
    CHECK(same_bits(world, restored));
    CHECK(relative_error(world.state().u, last) < 5e-3);
    last = world.state().u;
  }
  CHECK(region_of(world).full_tet_count() == before);
  CHECK_THROWS_WITH_AS(world.apply(KeepFull{{-1}, 0.1}), doctest::Contains("no vertex -1"), InputError);
  CHECK_THROWS_AS(world.apply(KeepFull{{setup.mesh.vertex_count()}, 0.1}), InputError);
  for (double duration : {0.0, std::nan(""), double(INFINITY)})
    CHECK_THROWS_WITH_AS(world.apply(KeepFull{end, duration}), doctest::Contains("duration"), InputError);
  World<double> without(all_nonlinear(setup)), same(all_nonlinear(setup));
  without.apply(KeepFull{end, 0.15});
  REQUIRE(without.advance(0.02).ok);
  REQUIRE(same.advance(0.02).ok);
  CHECK(same_bits(without, same));
}
