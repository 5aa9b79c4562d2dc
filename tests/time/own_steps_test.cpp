#include "lobe/time/own_steps.h"

#include <doctest/doctest.h>

#include <cstring>

#include "lobe/fem/svk.h"
#include "lobe/forces/applied_forces.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A bar of 2 × 2 × 24 cells, whose last two layers are stiff.
Setup stiff_ended_bar(double contrast) {
  constexpr double edge = 0.01;
  Setup setup = setup_of(box_mesh({2 * edge, 2 * edge, 24 * edge}, 2, 2, 24));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> jitter(-0.15 * edge, 0.15 * edge);
  for (double& x : setup.mesh.points.reshaped()) x += jitter(random);
  setup.materials = {{5e3, 2e3, 1000}, {5e3 * contrast, 2e3 * contrast, 1000}};
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.material_of[std::size_t(t)] = barycentre(setup.mesh, t).z() > 22 * edge;
  setup.safety = 0.8;
  return setup;
}

template <class Real>
World<Real> by_own_steps(Setup setup, int threads = 1) {
  setup.own_steps = true;
  return World<Real>(setup, threads);
}

// A turn, a wave along the bar and noise.
template <class Real>
State<Real> swinging(const World<Real>& world, double size) {
  const Mat3X<double> X = world.elements().points.view();
  State<Real> state{Mat3X<Real>::Zero(3, X.cols()), Mat3X<Real>::Zero(3, X.cols())};
  const Mat3X<double> noise = random_displacement(Index(X.cols()), 0.1 * size);
  const Vec3d centre = X.rowwise().mean(), turn(1, 3, 2);
  for (Index v = 0; v < X.cols(); ++v) {
    Vec3d velocity = noise.col(v) + 10 * size * turn.cross(Vec3d(X.col(v)) - centre);
    velocity.x() += size * std::sin(26 * X(2, v));
    state.v.col(v) = velocity.cast<Real>();
  }
  return state;
}

template <class Real>
double share_of(World<Real>& world, const std::vector<double>& durations, std::vector<Report>* reports = {}) {
  double evaluated = 0, all = 0;
  for (double duration : durations) {
    const Report report = world.advance(duration);
    REQUIRE(report.ok);
    evaluated += double(report.patches_evaluated);
    all += double(report.patches_evaluated + report.patches_skipped);
    if (reports) reports->push_back(report);
  }
  return evaluated / all;
}

std::vector<double> frames(int count, double duration = 1.0 / 60) {
  return std::vector<double>(std::size_t(count), duration);
}

Vec3d momentum(World<double>& world) {
  world.body().synchronise_velocities();
  const auto state = world.state();
  Vec3d sum = Vec3d::Zero();
  for (Index v = 0; v < state.v.cols(); ++v)
    sum += world.body().inertia.mass()[std::size_t(v)] * Vec3d(state.v.col(v));
  return sum;
}

Vec3d angular_momentum(World<double>& world) {
  world.body().synchronise_velocities();
  const auto state = world.state();
  Vec3d sum = Vec3d::Zero();
  for (Index v = 0; v < state.v.cols(); ++v)
    sum += world.body().inertia.mass()[std::size_t(v)] *
           Vec3d(world.elements().points.col(v) + state.u.col(v)).cross(Vec3d(state.v.col(v)));
  return sum;
}

// Levels of tetrahedra kick by themselves and all vertices move in each short step, in plain code.
struct Plain {
  std::vector<Level> of_tets;
  Mat3X<double> u, v;

  void advance(const World<double>& world, int steps, double dt, bool begins) {
    const Elements& elements = world.elements();
    const Level top = *std::max_element(of_tets.begin(), of_tets.end());
    for (int i = 0; i < steps; ++i) {
      Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
      const int within = i % (1 << top);
      for (Index t = 0; t < elements.topology.tet_count(); ++t) {
        const Level level = of_tets[std::size_t(t)];
        if (within % (1 << level) != 0) continue;
        const Shape shape = elements.shape_of(t);
        const Eigen::Vector4i corners = elements.topology.corners(t);
        const Mat34<double> at_corners = u(Eigen::all, corners);
        const Mat3<double> H = displacement_gradient<double>(at_corners, shape.gradients.rightCols<3>());
        const Elastic& elastic = elements.elastic_of(t);
        const Mat34<double> forces =
            corner_forces<double>(shape.volume * (1 << level) * svk_stress(H, elastic.lambda, elastic.mu),
                                  shape.gradients.rightCols<3>());
        for (int c = 0; c < 4; ++c) f.col(corners[c]) += forces.col(c);
      }
      for (Index w = 0; w < u.cols(); ++w)
        v.col(w) += (begins && i == 0 ? 0.5 : 1) * dt * world.body().inertia.inverse_mass(w) * f.col(w);
      u += dt * v;
    }
  }
};

std::vector<Level> levels_of_tets(World<double>& world) {
  const OwnSteps<double>& own = *world.body().own_steps;
  std::vector<Level> levels(std::size_t(world.elements().topology.tet_count()));
  std::size_t patch = 0;
  world.body().regions.visit_patches([&]<class Layout>(const Layout& layout, const auto&) {
    for (Index p = 0; p < layout.patch_count(); ++p, ++patch)
      if constexpr (std::is_same_v<Layout, PatchLayout<4>>)
        for (Index i = 0; i < layout.patch(p).items; ++i)
          levels[std::size_t(layout.id_of(p * Layout::capacity + i))] = own.levels()[patch];
  });
  return levels;
}

template <class Real>
bool same_bits(const World<Real>& a, const World<Real>& b) {
  const auto& one = a.body().motion;
  const auto& other = b.body().motion;
  const auto bytes = std::size_t(one.u.count()) * 3 * sizeof(Real);
  return std::memcmp(one.u.view().data(), other.u.view().data(), bytes) == 0 &&
         std::memcmp(one.v.view().data(), other.v.view().data(), bytes) == 0;
}

}  // namespace

TEST_CASE("patches are laid out by the pace of their vertices") {
  World<double> world = by_own_steps<double>(stiff_ended_bar(50));
  const PatchGraph& graph = world.body().own_steps->graph();
  double fast = 0, all = 0;
  for (std::size_t p = 0; p < graph.patches.size(); ++p) {
    all += graph.patches[p].cost;
    if (graph.patches[p].pace == 0) fast += graph.patches[p].cost;
    for (Index q : graph.neighbours[p])
      if (graph.patches[p].cost > 0)
        CHECK(std::abs(int(graph.patches[p].pace) - int(graph.patches[std::size_t(q)].pace)) <= 1);
  }
  CHECK(all == 24 * 24);
  CHECK(fast >= 2 * 24);
  CHECK(fast <= 5 * 24);
}

TEST_CASE("own steps are those of plain code") {
  World<double> world = by_own_steps<double>(stiff_ended_bar(50));
  world.set_state(swinging(world, 0.3));
  Plain plain{{}, world.state().u, world.state().v};
  std::vector<Report> reports;
  for (int frame = 0; frame < 3; ++frame) {
    CHECK(share_of(world, frames(1, 0.005), &reports) < 0.7);
    const std::vector<Level> levels = levels_of_tets(world);
    if (frame > 0) REQUIRE(levels == plain.of_tets);  // or velocities were brought up in between
    plain.of_tets = levels;
    CHECK(reports.back().reruns == 0);
    plain.advance(world, reports.back().steps, 0.005 / reports.back().steps, frame == 0);
    const auto u = world.state().u;
    CHECK(plain.u.norm() > 1e-3);
    CHECK((u - plain.u).norm() < 1e-11 * plain.u.norm());
  }
}

TEST_CASE("a body alike everywhere has the bits of one step for all") {
  for (const bool is_smoothed : {false, true}) {
    const Setup setup = is_smoothed ? smoothed(stiff_ended_bar(1)) : stiff_ended_bar(1);
    World<float> one(setup), own = by_own_steps<float>(setup);
    one.set_state(swinging(one, 0.3));
    own.set_state(swinging(own, 0.3));
    CHECK(share_of(own, frames(3)) == 1);
    share_of(one, frames(3));
    CHECK(same_bits(one, own));
    CHECK(own.body().own_steps->levels().empty());
  }
}

TEST_CASE("undamped, energy stays and momenta are conserved to rounding") {
  Setup setup = stiff_ended_bar(50);
  SUBCASE("plain") {}
  SUBCASE("edge-smoothed") { setup = smoothed(setup); }
  World<double> world = by_own_steps<double>(setup);
  world.set_state(swinging(world, 0.3));
  const double energy = world.energies().total();
  const Vec3d p = momentum(world), L = angular_momentum(world);
  CHECK(share_of(world, frames(60)) < 0.75);
  CHECK(world.body().own_steps->any());
  CHECK((momentum(world) - p).norm() < 1e-12 * p.norm());
  CHECK((angular_momentum(world) - L).norm() < 1e-9 * L.norm());
  CHECK(world.energies().total() == near(energy, 0.01));
}

TEST_CASE("own steps go where one step for all goes, with order 2") {
  double errors[3];
  Mat3X<double> exact;
  {
    Setup setup = stiff_ended_bar(50);
    setup.safety = 0.02;
    World<double> world(setup);
    world.set_state(swinging(world, 0.05));
    share_of(world, frames(1, 0.03));
    exact = world.state().u;
  }
  const double safeties[3] = {0.6, 0.3, 0.15};
  for (int i = 0; i < 3; ++i) {
    Setup setup = stiff_ended_bar(50);
    setup.safety = safeties[i];
    World<double> world = by_own_steps<double>(setup);
    world.set_state(swinging(world, 0.05));
    CHECK(share_of(world, frames(1, 0.03)) < 0.6);
    errors[i] = (world.state().u - exact).norm() / exact.norm();
  }
  CHECK(errors[0] < 0.02);
  CHECK(std::log2(errors[1] / errors[2]) > 1.7);
  CHECK(std::log2(errors[1] / errors[2]) < 2.3);
}

TEST_CASE_TEMPLATE("the same bits on any number of threads and after a checkpoint", Real, float, double) {
  Setup setup = stiff_ended_bar(13);
  SUBCASE("plain") {}
  SUBCASE("edge-smoothed") { setup = smoothed(setup); }
  World<Real> world = by_own_steps<Real>(setup), restored = by_own_steps<Real>(setup, 4),
              apart = by_own_steps<Real>(setup, 3);
  const State<Real> state = swinging(world, 0.3);
  world.set_state(state);
  apart.set_state(state);
  CHECK(share_of(world, frames(7, 0.004)) < 0.9);
  share_of(apart, frames(7, 0.004));
  CHECK(same_bits(world, apart));
  const Checkpoint<Real> kept = parse_checkpoint<Real>("kept", checkpoint_bytes(world.save()));
  CHECK_FALSE(kept.own_steps.levels.empty());
  restored.restore(kept);
  for (int i = 0; i < 8; ++i) {
    world.advance(0.004);
    restored.advance(0.004);
  }
  CHECK(same_bits(world, restored));
}

TEST_CASE("what force terms act on steps with the fastest, and stays where one step for all leaves it") {
  Setup setup = stiff_ended_bar(200);
  setup.damping = 20;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) > 0.237) setup.prescribed.push_back({v, Vec3d::Zero()});
  const auto pulled = [&](World<double>& world) {
    VertexLoad load;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (std::abs(setup.mesh.points(2, v) - 0.21) < 0.003) load.vertex = v;
    load.force = {0.05, 0, 0};
    world.apply(SetForces{{load}});
  };
  World<double> own = by_own_steps<double>(setup), one(setup);
  pulled(own);
  pulled(one);
  CHECK(share_of(own, frames(30)) < 0.8);
  share_of(one, frames(30));
  const Mat3X<double> u = one.state().u;
  CHECK(u.colwise().norm().maxCoeff() > 1e-3);
  CHECK((own.state().u - u).norm() < 0.005 * u.norm());
  REQUIRE(own.body().own_steps->any());
  const auto level_at = [&](double z) {
    Level lowest = highest_level;
    const std::vector<Level> levels = levels_of_tets(own);
    for (Index t = 0; t < setup.mesh.tet_count(); ++t)
      if (std::abs(barycentre(setup.mesh, t).z() - z) < 0.01)
        lowest = std::min(lowest, levels[std::size_t(t)]);
    return lowest;
  };
  CHECK(level_at(0.205) == 0);
  CHECK(level_at(0.02) > 0);
}

TEST_CASE("a body at rest under its weight stays at rest") {
  Setup setup = stiff_ended_bar(50);
  setup.gravity = {9.81, 0, 0};
  setup.damping = 60;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) > 0.237) setup.prescribed.push_back({v, Vec3d::Zero()});
  World<double> own = by_own_steps<double>(setup), one(setup);
  share_of(own, frames(150));
  share_of(one, frames(150));
  const Mat3X<double> u = one.state().u;
  // Where levels meet, slow kicks push a vertex to and fro about its place, by ⅛ of the acceleration of one
  // side times the square of the long step.
  CHECK((own.state().u - u).norm() < 5e-4 * u.norm());
}

TEST_CASE("a part that stiffens within a frame makes all step together in it") {
  Setup setup = stiff_ended_bar(50);
  setup.damping = 20;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    if (setup.mesh.points(2, v) > 0.237) setup.prescribed.push_back({v, Vec3d::Zero()});
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, {0, 0, -0.3}});
  }
  setup.ramp = 0.1;
  World<double> own = by_own_steps<double>(setup), restored = by_own_steps<double>(setup, 2);
  setup.own_steps = false;
  World<double> one(setup);
  int frame = 0, reruns = 0;
  for (; frame < 10 && reruns == 0; ++frame) {
    reruns = own.advance(0.02).reruns;
    CHECK(one.advance(0.02).reruns == 0);
  }
  REQUIRE(reruns == 1);
  for (frame = 0; frame < OwnSteps<double>::frames_together; ++frame) {
    CHECK_FALSE(own.body().own_steps->any());
    if (frame == 5) {
      CHECK(own.save().own_steps.squares.empty());  // no choice is due
      restored.restore(own.save());
    }
    REQUIRE(own.advance(0.02).ok);
  }
  CHECK(share_of(own, frames(15, 0.02)) < 0.9);
  for (int i = 5; i < frame + 15; ++i) restored.advance(0.02);
  CHECK(same_bits(own, restored));
}

TEST_CASE("tensor-mass tetrahedra step together") {
  Setup setup = stiff_ended_bar(13);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).z() < 0.1) setup.region_of[std::size_t(t)] = RegionModel::tensor_mass;
  World<double> own = by_own_steps<double>(setup), one(setup);
  own.set_state(swinging(own, 0.02));
  one.set_state(swinging(one, 0.02));
  CHECK(share_of(own, frames(6)) < 0.9);
  share_of(one, frames(6));
  const OwnSteps<double>& steps = *own.body().own_steps;
  REQUIRE(steps.any());
  std::vector<Level> tied;
  for (std::size_t p = 0; p < steps.levels().size(); ++p)
    if (steps.graph().patches[p].is_tied) tied.push_back(steps.levels()[p]);
  CHECK(tied.size() >= 1);
  for (Level level : tied) CHECK(level == tied.front());
  const Mat3X<double> u = one.state().u;
  CHECK((own.state().u - u).norm() < 0.02 * u.norm());
}

TEST_CASE("World::step() takes all together") {
  World<double> own = by_own_steps<double>(stiff_ended_bar(50));
  own.set_state(swinging(own, 0.3));
  own.advance(0.01);
  CHECK(own.body().own_steps->any());
  const double energy = own.energies().total();
  for (int i = 0; i < 20; ++i) CHECK(own.step(0.8 * own.time_step_limit()));
  CHECK_FALSE(own.body().own_steps->any());
  CHECK(own.energies().total() == near(energy, 0.02));
}
