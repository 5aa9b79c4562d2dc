// Tangles become linear until they come undone; nothing else does.
#include "lobe/time/unravelling.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "folder.h"
#include "lobe/fem/volume_term.h"
#include "lobe/io/mesh_io.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"
#include "squeezed_bar.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame = 1.0 / 60;  // [s]

template <class Real>
Index linear_count(World<Real>& world) {
  const auto& region_of = world.elements().region_of;
  return static_cast<Index>(std::count(region_of.begin(), region_of.end(), RegionModel::tensor_mass));
}

// All that have a vertex in common with one whose volume is less than a fifth of what it was.
std::vector<Index> around_crushed(World<double>& world) {
  const Elements& elements = world.elements();
  std::vector<char> is_near(std::size_t(elements.topology.vertex_count()), 0);
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Mat34<double> u = world.state().u(Eigen::all, elements.topology.corners(t));
    const Mat34<double> X = elements.corner_points(t);
    if (signed_volume(Mat34<double>(X + u)) < 0.2 * signed_volume(X))
      for (Index v : elements.topology.corners(t)) is_near[std::size_t(v)] = 1;
  }
  std::vector<Index> tets;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Eigen::Vector4i corners = elements.topology.corners(t);
    if (std::any_of(corners.begin(), corners.end(), [&](Index v) { return is_near[std::size_t(v)]; }))
      tets.push_back(t);
  }
  return tets;
}

// What is said of tangles in so many frames.
template <class Real>
std::vector<Condition> said(World<Real>& world, int frames) {
  std::vector<Condition> conditions;
  for (int i = 0; i < frames; ++i) {
    const Report report = world.advance(frame);
    REQUIRE(report.ok);
    std::copy_if(report.conditions.begin(), report.conditions.end(), std::back_inserter(conditions),
                 [](const Condition& c) { return c.kind == Condition::Kind::unravelling; });
  }
  return conditions;
}

template <class Real>
std::vector<Condition> said_of(const Setup& setup, int frames = 90) {
  World<Real> world(setup);
  return said(world, frames);
}

// The shipped beam; one of the vertices that are held at its end is held by a grasp, until it lets go.
Setup beam(double let_go) {
  Setup setup = setup_of(read_mesh(std::filesystem::path(LOBE_DATA_DIR) / "meshes" / "beam_1k.vtu").mesh);
  setup.guard_below = 0.2;
  setup.damping = 30;
  const auto x = setup.mesh.points.row(0);
  const double below = x.minCoeff() + 0.1 * (x.maxCoeff() - x.minCoeff());
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (x[v] < below) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.grasps = {
      {"grasper", {setup.prescribed.back().vertex}, {{0, Vec3d::Zero()}, {let_go, Vec3d::Zero()}}, true}};
  setup.prescribed.pop_back();
  return setup;
}

// A cube that is held at one end, all else of it in a point but for a millimetre.
template <class Real>
World<Real> collapsed_cube(int degree, unsigned seed) {
  Setup setup = setup_of(irregular_box(3));
  setup.guard_below = 0.2;
  setup.volume_penalty = 1e5;
  setup.damping = 30;
  setup.selective_mass = degree;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  World<Real> world(setup);
  State<Real> state = world.state();
  const Vec3d middle = setup.mesh.points.rowwise().mean();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1e-3, 1e-3);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (!world.held().holds(v)) {
      const Vec3d off(uniform(random), uniform(random), uniform(random));
      state.u.col(v) = (middle + off - setup.mesh.points.col(v)).template cast<Real>();
    }
  world.set_state(state);
  return world;
}

// At 20 m/s against its end.
template <class Real>
void throw_it(World<Real>& world) {
  State<Real> state = world.state();
  state.v = Vec3<Real>(-20, 0, 0).replicate(1, state.v.cols());
  for (const HeldVertices::Held& item : world.held().all()) state.v.col(item.vertex).setZero();
  world.set_state(state);
}

}  // namespace

TEST_CASE_TEMPLATE("a beam thrown into a tangle stays in it while a tool holds it, and then comes back", Real,
                   float, double) {
  World<Real> world(beam(1.5));
  throw_it(world);
  CHECK(said(world, 89).empty());
  CHECK(world.advance(frame).smallest_volume_ratio < 0.1);
  CHECK(linear_count(world) == 0);
  const std::vector<Condition> conditions = said(world, 150);
  REQUIRE(conditions.size() >= 2);
  CHECK(conditions.front().text.find("stay crushed or inverted") != std::string::npos);
  CHECK(conditions.back().text.find("have come back") != std::string::npos);
  CHECK(linear_count(world) == 0);
  CHECK(world.advance(frame).smallest_volume_ratio > 0.99);
  CHECK(double(world.state().u.colwise().norm().maxCoeff()) < 1e-4);
}

TEST_CASE("what does not come back becomes linear ring by ring, at last all of it, and then never again") {
  World<double> world(squeezed_bar());
  std::vector<Index> counts{0};
  for (int i = 0; i < 120; ++i) {
    const std::vector<Index> expected = around_crushed(world);
    REQUIRE(world.advance(frame).ok);
    if (counts.back() == linear_count(world)) continue;
    counts.push_back(linear_count(world));
    if (counts.size() == 2) CHECK(world.save().unravelling.tets == expected);
  }
  REQUIRE(counts.size() >= 4);
  CHECK(std::is_sorted(counts.begin(), counts.end() - 1));
  CHECK(counts[counts.size() - 2] == 144);
  CHECK(counts.back() == 0);
  CHECK(world.save().unravelling.stage == Unravelling::stages);
}

TEST_CASE("only guarded, held tetrahedra that nothing drives, in explicit steps, become linear") {
  CHECK(said_of<float>(squeezed_bar()).size() > 2);
  Setup unguarded = squeezed_bar(), loose = squeezed_bar(), implicit = squeezed_bar(), led = squeezed_bar();
  unguarded.guard_below = 0;
  CHECK(said_of<float>(unguarded).empty());
  loose.prescribed.clear();
  CHECK(said_of<float>(loose).empty());
  led.prescribed.front().displacement = {0, 1e-6, 0};
  CHECK(said_of<float>(led).empty());
  implicit.integrator = Integrator::generalised_alpha;
  World<double> explicit_world(squeezed_bar()), implicit_world(implicit);
  CHECK(said(explicit_world, 15).empty());
  implicit_world.set_state(explicit_world.state());
  CHECK(said(implicit_world, 60).empty());
  CHECK(implicit_world.advance(frame).smallest_volume_ratio < 0.1);
}

TEST_CASE("a bar that loads draw out or bend far stays non-linear") {
  const auto pulled = [](const Vec3d& force) {
    Setup setup = slow_bar();
    setup.damping = 20;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (setup.mesh.points(0, v) > 0.059) setup.vertex_loads.push_back({v, force / 9});
    World<float> world(setup);
    CHECK(said(world, 120).empty());
    return double(world.state().u.colwise().norm().maxCoeff()) / 0.06;
  };
  CHECK(pulled({8, 0, 0}) > 0.3);
  CHECK(pulled({0, 0, 1}) > 0.6);
}

TEST_CASE_TEMPLATE("while it unravels a world is saved, restored and replayed with the same bits", Real,
                   float, double) {
  const Setup setup = beam(0.01);
  World<Real> world(setup);
  throw_it(world);
  const Checkpoint<Real> start = world.save();
  CommandRecorder<Real> recorded(world);
  for (int i = 0; i < 90 && !world.is_unravelling(); ++i) recorded.advance(frame);
  REQUIRE(world.is_unravelling());
  const Folder folder;
  write_checkpoint(folder.path / "state", world.save());
  World<Real> restored(setup, 2), replayed(setup, 2);
  restored.restore(read_checkpoint<Real>(folder.path / "state"));
  CHECK(restored.is_unravelling());
  for (int i = 0; i < 60; ++i) {
    recorded.advance(frame);
    restored.advance(frame);
    CHECK(same_bits(world, restored));
  }
  CHECK_FALSE(world.is_unravelling());
  CHECK(world.journal().edits == restored.journal().edits);
  replayed.restore(start);
  CHECK(replay(recorded.recording(), replayed).same);
}

TEST_CASE("what somebody else makes linear meanwhile stays so") {
  World<double> world(squeezed_bar());
  for (int i = 0; i < 60 && !world.is_unravelling(); ++i) world.advance(frame);
  REQUIRE(world.is_unravelling());
  world.apply(
      SetRegion{{world.save().unravelling.tets.front()}, RegionModel::tensor_mass});  // it is so already
  for (int i = 0; i < 120 && world.is_unravelling(); ++i) world.advance(frame);
  CHECK(linear_count(world) == 1);
}

TEST_CASE_TEMPLATE("selective masses wait while a collapsed body comes back", Real, float, double) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    CAPTURE(seed);
    World<Real> world = collapsed_cube<Real>(16, seed);
    CHECK_FALSE(world.save().unravelling.is_lumped);
    REQUIRE(world.advance(frame).ok);
    CHECK(world.save().unravelling.is_lumped);
    CHECK(world.body().inertia.degree() == 16);
    const double limit = world.time_step_limit();
    REQUIRE(said(world, 119).empty());
    CHECK_FALSE(world.save().unravelling.is_lumped);
    CHECK(world.time_step_limit() > 4 * limit);
    CHECK(world.advance(frame).smallest_volume_ratio > 0.99);
  }
}

TEST_CASE_TEMPLATE("while selective masses wait a world is saved, restored and replayed with the same bits",
                   Real, float, double) {
  World<Real> world = collapsed_cube<Real>(9, 1);
  const Checkpoint<Real> start = world.save();
  CommandRecorder<Real> recorded(world);
  recorded.advance(frame);
  const Folder folder;
  write_checkpoint(folder.path / "state", world.save());
  World<Real> restored = collapsed_cube<Real>(9, 2), replayed = collapsed_cube<Real>(9, 2);
  restored.restore(read_checkpoint<Real>(folder.path / "state"));
  CHECK(restored.time_step_limit() == world.time_step_limit());
  for (int i = 0; i < 60; ++i) {
    if (i == 1) {
      CHECK(world.save().unravelling.is_lumped);
      recorded.apply(SetMassDegree{5});
      restored.apply(SetMassDegree{5});
    }
    recorded.advance(frame);
    restored.advance(frame);
    CHECK(same_bits(world, restored));
  }
  CHECK(world.body().inertia.degree() == 5);
  CHECK_FALSE(world.save().unravelling.is_lumped);
  replayed.restore(start);
  CHECK(replay(recorded.recording(), replayed).same);
}

TEST_CASE("selective masses do not wait where a tool crushes a body, nor without the guard") {
  Setup setup = squeezed_bar();
  setup.selective_mass = 9;
  Setup led = setup, unguarded = setup;
  led.prescribed.front().displacement = {0, 1e-6, 0};
  unguarded.guard_below = 0;
  const auto waits = [](const Setup& s) {
    World<double> world(s);
    bool lumped = false;
    for (int i = 0; i < 20; ++i) {
      REQUIRE(world.advance(frame).ok);
      lumped = lumped || world.save().unravelling.is_lumped;
    }
    CHECK(world.advance(frame).smallest_volume_ratio < 0.1);
    return lumped;
  };
  CHECK(waits(setup));
  CHECK_FALSE(waits(led));
  CHECK_FALSE(waits(unguarded));
}
