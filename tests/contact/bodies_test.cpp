// Contact between bodies: points and stiffness of each pair, and what the step limit knows of a touch.
#include <doctest/doctest.h>

#include <cmath>

#include "lobe/contact/contact.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Elastic elastic(double young, double poisson) {
  return {.lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
          .mu = young / (2 * (1 + poisson)),
          .density = 1000};
}

TetMesh moved_box(const Vec3d& size, int nx, int ny, int nz, const Vec3d& at) {
  TetMesh box = box_mesh(size, nx, ny, nz);
  box.points.colwise() += at;
  return box;
}

// Two boxes, of one material each; the first one is held at its bottom.
Setup two_boxes(const TetMesh& below, const TetMesh& above, const Elastic& of_below,
                const Elastic& of_above) {
  Setup setup;
  append_body(below, "below", setup.mesh);
  append_body(above, "above", setup.mesh);
  setup.materials = {of_below, of_above};
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.material_of.push_back(std::uint16_t(setup.mesh.bodies.body_of(t)));
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.contact.self = true;
  setup.contact.friction = 0;
  setup.damping = 20;
  const double bottom = setup.mesh.points.row(2).minCoeff();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < bottom + 1e-9) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

// A pressure on the upper side of the upper box, dead [Pa].
void load_top(Setup& setup, double pressure) {
  const double top = setup.mesh.points.row(2).maxCoeff();
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    for (int face = 0; face < 4; ++face) {
      const auto is_top = [&](int c) { return setup.mesh.points(2, setup.mesh.tets(c, t)) > top - 1e-9; };
      const int* c = face_corners[face];
      if (is_top(c[0]) && is_top(c[1]) && is_top(c[2]))
        setup.face_loads.push_back({t, face, Vec3d(0, 0, -pressure)});
    }
}

double mean_height(const TetMesh& mesh, const Mat3X<double>& u, double z) {
  double sum = 0;
  int count = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (std::abs(mesh.points(2, v) - z) > 1e-9) continue;
    sum += u(2, v);
    ++count;
  }
  return sum / count;
}

template <class Real>
Report play(World<Real>& world, double duration, double frame = 1.0 / 60) {
  Report all;
  for (int i = 0; i < int(std::lround(duration / frame)); ++i) {
    const Report report = world.advance(frame);
    all.ok = all.ok && report.ok;
    all.steps += report.steps;
    all.reruns += report.reruns;
  }
  return all;
}

}  // namespace

TEST_CASE("two blocks that are pressed together shorten as springs in series, whatever their meshes") {
  struct Blocks {
    double contrast;
    int cells_below, cells_above;
  };
  for (const auto& [contrast, cells_below, cells_above] :
       {Blocks{1, 4, 4}, Blocks{10, 4, 3}, Blocks{10, 2, 6}, Blocks{0.1, 2, 6}}) {
    CAPTURE(contrast);
    CAPTURE(cells_above);
    constexpr double size = 0.04, young = 5e3, pressure = 1;
    Setup setup =
        two_boxes(moved_box({size, size, size}, cells_below, cells_below, cells_below, {0, 0, 0}),
                  moved_box({size, size, size}, cells_above, cells_above, cells_above, {0, 0, size}),
                  elastic(young, 0), elastic(young * contrast, 0));
    load_top(setup, pressure);
    World<double> world(setup);
    CHECK(play(world, 1.5).ok);
    const Mat3X<double> u = world.state().u;
    const double shortened = -mean_height(setup.mesh, u, 2 * size);
    CHECK(shortened == near(pressure * size / young * (1 + 1 / contrast), 0.02));
    // The stress in each is the pressure: nothing is lost between them.
    const Index middle = mesh_of_body(setup.mesh, 0).vertex_count();
    double below = 0;
    for (Index v = 0; v < middle; ++v)
      if (std::abs(setup.mesh.points(2, v) - size) < 1e-9) below = std::min(below, u(2, v));
    CHECK(-below == near(pressure * size / young, 0.02));
  }
}

TEST_CASE("a block on an incline slips where the slope is above the friction, and stays where it is below") {
  constexpr double friction = 0.3, gravity = 9.81, drag = 5, duration = 0.1;
  struct Meshes {
    int cells_below, cells_above;
  };
  for (const auto& [cells_below, cells_above] : {Meshes{6, 2}, Meshes{3, 3}, Meshes{3, 6}})
    for (const double slope : {0.95 * friction, 1.05 * friction, 2 * friction}) {
      CAPTURE(cells_above);
      CAPTURE(slope);
      Setup setup = two_boxes(moved_box({0.12, 0.04, 0.01}, 3 * cells_below, cells_below, 1, {0, 0, 0}),
                              moved_box({0.03, 0.03, 0.01}, cells_above, cells_above, 1, {0.01, 0.005, 0.01}),
                              elastic(5e5, 0.3), elastic(5e5, 0.3));
      setup.contact.friction = friction;
      setup.damping = drag;
      const double angle = std::atan(slope);
      setup.gravity = gravity * Vec3d(0, 0, -1);  // flat at first, until the block has come to rest
      World<double> flat(setup);
      CHECK(play(flat, 0.6).ok);
      const State<double> at_rest = flat.state();
      setup.gravity = gravity * Vec3d(std::sin(angle), 0, -std::cos(angle));
      World<double> world(setup);
      world.set_state({at_rest.u, at_rest.v, 0});
      CHECK(play(world, slope < friction ? 0.5 : duration).ok);  // it swings at first
      const Index first = mesh_of_body(setup.mesh, 0).vertex_count();
      const auto of_block = [&](const Mat3X<double>& values) {
        return values.row(0).tail(values.cols() - first).mean();
      };
      const double before = of_block(world.state().v), from = of_block(world.state().u);
      CHECK(play(world, duration).ok);
      if (slope < friction) {
        CHECK(std::abs(of_block(world.state().u) - from) < 2e-5);
        continue;
      }
      // v' = g cos α (tan α − μ) − γ v
      const double left = std::exp(-drag * duration);
      const double pull = (of_block(world.state().v) - before * left) * drag / (1 - left);
      CHECK(slope - pull / (gravity * std::cos(angle)) == near(friction, 0.02));
    }
}

TEST_CASE("bodies whose faces coincide at the start come to rest on each other, in both precisions") {
  const auto check = [](auto real, int cells) {
    using Real = decltype(real);
    CAPTURE(sizeof(Real));
    CAPTURE(cells);
    Setup setup = two_boxes(moved_box({0.04, 0.04, 0.02}, 4, 4, 2, {0, 0, 0}),
                            moved_box({0.03, 0.03, 0.004}, cells, cells, 2, {0.00523, 0.005, 0.02}),
                            elastic(5e3, 0.4), elastic(5e4, 0.4));
    setup.gravity = {0, 0, -9.81};
    setup.contact.friction = 0.1;
    World<Real> world(setup);
    const Report report = play(world, 0.8);
    CHECK(report.ok);
    CHECK(world.energies().kinetic < 1e-9);
    CHECK(world.energies().applied < 1e-6);
    const Mat3X<double> u = world.state().u.template cast<double>();
    CHECK(u.row(2).minCoeff() > -1e-3);
  };
  for (int cells : {4, 8, 12}) {
    check(0.0F, cells);
    check(0.0, cells);
  }
}

TEST_CASE("a body that falls on another is known to the step limit before it touches") {
  for (int cells : {3, 8}) {
    CAPTURE(cells);
    Setup setup = two_boxes(moved_box({0.04, 0.04, 0.02}, 4, 4, 2, {0, 0, 0}),
                            moved_box({0.03, 0.03, 0.01}, cells, cells, 2, {0.005, 0.005, 0.025}),
                            elastic(5e3, 0.4), elastic(5e4, 0.4));
    setup.gravity = {0, 0, -9.81};
    World<float> world(setup);
    const Report report = play(world, 0.3);
    CHECK(report.ok);
    CHECK(report.reruns == 0);
    CHECK(world.energies().applied > 0);  // it has touched
    const Mat3X<float> u = world.state().u;
    CHECK(u.row(2).minCoeff() > -0.007F);  // and lies on the other one
  }
}

TEST_CASE("a body that is restored before it touches takes the same steps, whoever asks for the step limit") {
  Setup setup = two_boxes(moved_box({0.04, 0.04, 0.02}, 4, 4, 2, {0, 0, 0}),
                          moved_box({0.03, 0.03, 0.01}, 8, 8, 2, {0.005, 0.005, 0.025}), elastic(5e3, 0.4),
                          elastic(5e4, 0.4));
  setup.gravity = {0, 0, -9.81};
  World<float> world(setup), other(setup);
  CHECK(play(world, 1.0 / 60).ok);
  other.restore(world.save());
  other.time_step_limit();
  CHECK(play(world, 0.1, 1.0 / 60).ok);
  CHECK(play(other, 0.1, 1.0 / 60).ok);
  CHECK(world.energies().applied > 0);
  CHECK(same_bits(world, other));
}

TEST_CASE("momentum is kept where a fine body meets a coarse one, and so are the bits after a restore") {
  Setup setup = two_boxes(moved_box({0.04, 0.04, 0.02}, 3, 3, 2, {0, 0, 0}),
                          moved_box({0.03, 0.03, 0.01}, 8, 8, 3, {0.005, 0.007, 0.0202}), elastic(5e3, 0.4),
                          elastic(2e4, 0.4));
  setup.prescribed.clear();
  setup.damping = 0;
  setup.contact.friction = 0.2;
  World<double> world(setup), other(setup);
  State<double> state = world.state();
  const Index first = mesh_of_body(setup.mesh, 0).vertex_count();
  state.v.rightCols(state.v.cols() - first).colwise() = Vec3d(0.05, 0, -0.1);
  world.set_state(state);
  const auto momentum = [](World<double>& of) {
    Vec3d sum = Vec3d::Zero();
    const Mat3X<double> v = of.state().v;
    for (Index i = 0; i < v.cols(); ++i) sum += of.body().inertia.mass()[std::size_t(i)] * v.col(i);
    return sum;
  };
  const Vec3d before = momentum(world);
  CHECK(play(world, 0.006, 0.001).ok);
  CHECK(world.energies().applied > 0);
  CHECK((momentum(world) - before).norm() < 1e-10 * before.norm());
  other.restore(world.save());
  CHECK(play(world, 0.02, 0.002).ok);
  CHECK(play(other, 0.02, 0.002).ok);
  CHECK(same_bits(world, other));
}
