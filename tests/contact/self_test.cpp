#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "contact/frame.h"
#include "joined_meshes.h"
#include "lobe/contact/contact.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

TetMesh block(const Vec3d& size, int n, const Vec3d& at) {
  TetMesh mesh = box_mesh(size, n, n, n);
  mesh.points.colwise() += at;
  return mesh;
}

// A block that is pressed by a twentieth of its height; perhaps with a slit in its middle, whose lips touch.
Setup pressed(bool with_slit, bool self) {
  constexpr int n = 8;
  constexpr double edge = 0.04;
  TetMesh mesh = box_mesh(Vec3d::Constant(edge), n, n, n);
  if (with_slit) {
    std::map<Index, Index> copy_of;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3d x = mesh.points.col(v) / edge;
      const bool is_in_slit =
          std::abs(x[2] - 0.5) < 1e-9 && std::max(std::abs(x[0] - 0.5), std::abs(x[1] - 0.5)) < 0.3;
      if (is_in_slit) copy_of.emplace(v, mesh.vertex_count() + static_cast<Index>(copy_of.size()));
    }
    const Index before = mesh.vertex_count();
    mesh.points.conservativeResize(3, before + static_cast<Index>(copy_of.size()));
    for (const auto& [v, copy] : copy_of) mesh.points.col(copy) = mesh.points.col(v);
    for (Index t = 0; t < mesh.tet_count(); ++t) {
      if (barycentre(mesh, t).z() < edge / 2) continue;
      for (Index& v : mesh.tets.col(t))
        if (const auto found = copy_of.find(v); found != copy_of.end()) v = found->second;
    }
  }
  Setup setup = setup_of(mesh, RegionModel::tensor_mass);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.points(2, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
    if (mesh.points(2, v) > edge - 1e-9) setup.prescribed.push_back({v, {0, 0, -edge / 20}});
  }
  setup.damping = 60;
  setup.contact.self = self;
  setup.contact.friction = 0;
  return setup;
}

double energy_at_rest(const Setup& setup) {
  World<double> world(setup, 2);
  for (int i = 0; i < 25; ++i) REQUIRE(world.advance(frame).ok);
  return world.energies().elastic_linear;
}

}  // namespace

TEST_CASE("a slit that is pressed shut is as stiff as the block without it") {
  const double whole = energy_at_rest(pressed(false, false)), shut = energy_at_rest(pressed(true, true)),
               loose = energy_at_rest(pressed(true, false));
  MESSAGE("shut " << shut / whole << ", without contact " << loose / whole);
  CHECK(shut == near(whole, 0.02));
  CHECK(loose < 0.95 * whole);
}

TEST_CASE("a slit has no force until its lips overlap") {
  World<double> world([] {
    Setup setup = pressed(true, true);
    setup.prescribed.clear();
    return setup;
  }());
  world.advance(frame);
  CHECK(world.forces().norm() < 1e-12);
  CHECK(world.energies().applied < 1e-18);
}

TEST_CASE("stress is the same on both sides of two blocks whose meshes do not match") {
  constexpr double edge = 0.03;
  const TetMesh mesh =
      joined(block({edge, edge, edge}, 4, Vec3d::Zero()), block({edge, edge, edge}, 5, {0, 0, edge}));
  Setup setup = setup_of(mesh, RegionModel::tensor_mass);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d x = mesh.points.col(v);
    const bool is_top = x[2] > 2 * edge - 1e-9;
    const Axes axes{x[0] < 1e-9, x[1] < 1e-9, x[2] < 1e-9 || is_top};
    if (axes[0] || axes[1] || axes[2]) setup.prescribed.push_back({v, {0, 0, is_top ? -0.001 : 0}, axes});
  }
  setup.damping = 60;
  setup.contact.self = true;
  setup.contact.friction = 0;
  World<double> world(setup, 2);
  for (int i = 0; i < 30; ++i) REQUIRE(world.advance(frame).ok);
  const Mat3X<double> u = world.displacements();
  std::vector<double> stresses;
  double mean = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> X = tet_points(mesh, t), own = u(Eigen::all, mesh.tets.col(t));
    const Mat3<double> edges = X.rightCols<3>().colwise() - X.col(0),
                       moved = own.rightCols<3>().colwise() - own.col(0);
    const Mat3<double> H = moved * edges.inverse();
    stresses.push_back(seed_material.lambda * H.trace() + 2 * seed_material.mu * H(2, 2));
    mean += stresses.back() / mesh.tet_count();
  }
  REQUIRE(mean < -100);
  double worst = 0;
  for (double stress : stresses) worst = std::max(worst, std::abs(stress / mean - 1));
  MESSAGE("stress " << mean << " Pa, deviates by " << worst);
  CHECK(worst < 0.02);
}

TEST_CASE("pieces that collide keep their momentum and gain no energy, with friction, on any threads") {
  const TetMesh mesh = joined(irregular_box(3), [] {
    TetMesh other = irregular_box(4, 0.007, 2);
    other.points.colwise() += Vec3d(0.004, 0.006, 0.036);
    return other;
  }());
  Setup setup = setup_of(mesh);
  setup.contact.self = true;
  setup.contact.friction = 0.2;
  const auto launch = [&](World<float>& world) {
    State<float> state = world.state();
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.points(2, v) > 0.033) state.v.col(v) = Vec3<float>(0.1F, 0, -0.6F);
    world.set_state(state);
  };
  World<float> world(setup), other(setup, 7);
  launch(world);
  launch(other);
  const auto sums = [&](World<float>& simulated) {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    const StateView<float> state = simulated.state();
    for (Index v = 0; v < state.u.cols(); ++v) {
      const double m = simulated.body().inertia.mass()[std::size_t(v)];
      const Vec3d x = simulated.elements().points.col(v) + state.u.col(v).cast<double>();
      sum.head<3>() += m * state.v.col(v).cast<double>();
      sum.tail<3>() += m * x.cross(state.v.col(v).cast<double>());
    }
    return sum;
  };
  const auto before = sums(world);
  const double energy = world.energies().total();
  double most = 0;
  for (int i = 0; i < 40; ++i) {
    REQUIRE(world.advance(0.002).ok);
    other.advance(0.002);
    most = std::max(most, world.energies().total());
  }
  const auto after = sums(world);
  const double lower = world.state().v.row(2).head(27).mean();
  CHECK(lower < -0.05);  // it was hit
  CHECK((after - before).head<3>().norm() < 1e-5 * before.head<3>().norm());
  CHECK((after - before).tail<3>().norm() < 1e-3 * before.tail<3>().norm());
  CHECK(most < energy * 1.01);
  CHECK(same_bits(world, other));
}

TEST_CASE("a piece that falls lies on what is below it, and goes on from a checkpoint with the same bits") {
  const TetMesh mesh = joined(block({0.04, 0.04, 0.02}, 4, Vec3d::Zero()),
                              block({0.02, 0.02, 0.01}, 3, {0.011, 0.009, 0.024}));
  Setup setup = setup_of(mesh);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(2, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -9.81};
  setup.damping = 10;
  setup.contact.self = true;
  setup.contact.friction = 0.3;
  World<float> world(setup), restored(setup, 2);
  for (int i = 0; i < 25; ++i) {
    if (i == 15) restored.restore(world.save());
    REQUIRE(world.advance(frame).ok);
    if (i >= 15) restored.advance(frame);
  }
  CHECK(same_bits(world, restored));
  double lowest = 1;
  for (Index v = 125; v < mesh.vertex_count(); ++v)
    lowest = std::min(lowest, mesh.points(2, v) + double(world.state().u(2, v)));
  CHECK(lowest > 0.0185);
  CHECK(lowest < 0.0205);
}
