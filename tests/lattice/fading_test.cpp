#include "lobe/lattice/fading.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "lattice_worlds.h"
#include "lobe/sim/checkpoint.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Nodes and vertices that moved by amounts that have nothing to do with each other, at 2 s.
struct Rough {
  Rough() {
    box.embedding.mass.assign(std::size_t(box.lattice.node_count()), 1);
    for (Index v = 0; v < box.setup.mesh.vertex_count(); v += 3) box.embedding.interface.push_back(v);
    motion.time = 2;
    motion.extend(box.setup.mesh.vertex_count());
    motion.u.view() = 1e-3 * random_displacement(box.setup.mesh.vertex_count(), 1);
    motion.nodes.u = 1e-3 * random_displacement(box.lattice.node_count(), 1, 2);
    motion.nodes.v = 1e-2 * random_displacement(box.lattice.node_count(), 1, 3);
    wanted = motion.u.view();
    fading.begin(box.elements, box.lattice, box.embedding, motion);
  }
  // What nodes make of displacements and velocities at a time, and what is left.
  void recover(double time) {
    motion.time = time;
    motion.u.view() = interpolated(box, motion.nodes.u);
    motion.v.view() = interpolated(box, motion.nodes.v);
    fading.add(true, motion);
  }

  EmbeddedBox box;
  Motion<double> motion;
  Mat3X<double> wanted;
  Fading<double> fading;
};

}  // namespace

TEST_CASE("what the nodes cannot make of displacements is there at first, then less and less, then nothing") {
  Rough rough;
  const Mat3X<double> made = interpolated(rough.box, rough.motion.nodes.u);
  const double T = Fading<double>::duration;
  double last = (rough.wanted - made).norm();
  for (double share : {1.0, 0.25, 0.0}) {
    rough.recover(2 + T * (1 - std::sqrt(share)));
    CHECK((rough.motion.u.view() - (made + share * (rough.wanted - made))).norm() < 1e-12 * last);
  }
  rough.fading.forget_if_over(2 + 0.99 * T);
  CHECK(rough.fading.any());
  rough.fading.forget_if_over(2 + T);
  CHECK_FALSE(rough.fading.any());
}

TEST_CASE("velocities are the derivatives of displacements while these fade") {
  Rough rough;
  const double time = 2.03, h = 1e-6;
  rough.recover(time);
  const Mat3X<double> v = rough.motion.v.view(), q = rough.motion.nodes.u;
  Mat3X<double> u[2];
  for (int i = 0; i < 2; ++i) {
    const double step = i == 0 ? -h : h;
    rough.motion.nodes.u = q + step * rough.motion.nodes.v;
    rough.recover(time + step);
    u[i] = rough.motion.u.view();
  }
  CHECK(((u[1] - u[0]) / (2 * h) - v).norm() < 1e-7 * v.norm());
}

TEST_CASE("what fades turns with the lattice") {
  Rough rough;
  rough.recover(2.03);
  const Mat3X<double> X = rough.box.setup.mesh.points, x = X + rough.motion.u.view();
  const Mat3<double> R = Eigen::AngleAxisd(2, Vec3d(1, 2, -1).normalized()).toRotationMatrix();
  const Vec3d t(0.1, -0.2, 0.3);
  rough.motion.nodes.u =
      ((R * (rough.box.lattice.nodes + rough.motion.nodes.u)).colwise() + t) - rough.box.lattice.nodes;
  rough.recover(2.03);
  const Mat3X<double> turned = (R * x).colwise() + t;
  CHECK((X + rough.motion.u.view() - turned).norm() < 1e-13 * turned.norm());
}

TEST_CASE("a force on a vertex has the same sum and moment where the nodes take it, while it fades") {
  Rough rough;
  const Lattice& lattice = rough.box.lattice;
  rough.recover(2.03);
  rough.motion.forces.view().setZero();
  const Index v = rough.box.embedding.interface[20];
  rough.motion.forces.col(v) = Vec3d(1, -2, 3);
  rough.motion.node_forces.setZero(3, lattice.node_count());
  const CellWeights w = lattice.weights(v, rough.box.elements.points.col(v));
  const auto& nodes = lattice.parts[std::size_t(lattice.part_of_vertex[std::size_t(v)])].nodes;
  for (int n = 0; n < 8; ++n)
    rough.motion.node_forces.col(nodes[std::size_t(n)]) += w[n] * rough.motion.forces.col(v);
  rough.fading.add_forces(rough.motion);
  Vec3d sum = Vec3d::Zero(), moment = sum;
  for (Index n = 0; n < lattice.node_count(); ++n) {
    const Vec3d f = rough.motion.node_forces.col(n);
    sum += f;
    moment += Vec3d(lattice.nodes.col(n) + rough.motion.nodes.u.col(n)).cross(f);
  }
  const Vec3d f = rough.motion.forces.col(v), x = rough.box.elements.points.col(v) + rough.motion.u.col(v);
  CHECK((sum - f).norm() < 1e-13);
  CHECK((moment - x.cross(f)).norm() < 1e-14);
}

TEST_CASE("corners of full tetrahedra fade as all vertices do") {
  Rough rough;
  rough.recover(2.03);
  const Mat3X<double> u = rough.motion.u.view(), v = rough.motion.v.view();
  rough.motion.u.view() = interpolated(rough.box, rough.motion.nodes.u);
  rough.motion.v.view() = interpolated(rough.box, rough.motion.nodes.v);
  Parallel parallel(3);
  rough.fading.add_at_full(true, rough.motion, parallel);
  for (Index i : rough.box.embedding.interface) {
    CHECK(rough.motion.u.col(i) == u.col(i));
    CHECK(rough.motion.v.col(i) == v.col(i));
  }
  CHECK_FALSE(rough.motion.u.view() == u);
}

TEST_CASE("in a cell that is crushed to a point nothing is left") {
  Rough rough;
  rough.motion.nodes.u = -rough.box.lattice.nodes;
  rough.fading.begin(rough.box.elements, rough.box.lattice, rough.box.embedding, rough.motion);
  CHECK_FALSE(rough.fading.any());
}

TEST_CASE("displacements do not jump when a lattice takes over, and what is left is gone after a while") {
  const Setup setup = pulled_bar();
  World<double> world(setup);
  const double instant = 1e-8;
  double largest = 0, left_over = 0, in_between = 0;
  int takeovers = 0;
  for (int i = 0; i < 40; ++i) {
    const Mat3X<double> before = world.state().u;
    const double fastest = world.state().v.colwise().norm().maxCoeff();
    const Index full = region_of(world).full_tet_count();
    REQUIRE(world.advance(instant).ok);
    const double jump = (world.state().u - before).colwise().norm().maxCoeff();
    largest = std::max(largest, jump - 2 * instant * fastest);
    const Mat3X<double> left = region_of(world).fading(world.body().motion);
    if (region_of(world).full_tet_count() < full && left.size() > 0) {
      ++takeovers;
      left_over = std::max(left_over, left.colwise().norm().maxCoeff());
      World<double> restored(setup, 2);
      restored.restore(world.save());
      CHECK(restored.body().regions.reduced().fading(restored.body().motion) == left);
      world.advance(0.01 - instant);
      restored.advance(0.01 - instant);
      CHECK(same_bits(world, restored));
      const Mat3X<double> later = region_of(world).fading(world.body().motion);
      in_between = std::max(in_between, later.colwise().norm().maxCoeff());
      world.advance(0.01);
    } else {
      REQUIRE(world.advance(0.02 - instant).ok);
    }
  }
  MESSAGE("jumps of " << 1e3 * largest << " mm at most; what was left " << 1e3 * left_over << " mm");
  CHECK(takeovers >= 2);
  CHECK(largest < 2 * Fading<double>::least * region_of(world).lattice().frame.edge);
  CHECK(left_over > 1e-4);
  CHECK(in_between < left_over);
  CHECK(in_between > 0.5 * left_over);
  CHECK(region_of(world).any_embedded());
  CHECK(region_of(world).fading(world.body().motion).size() == 0);
}

TEST_CASE("a state that is set is there to be read, however rough it is") {
  World<double> world(bar(12, 4));
  State<double> state = world.state();
  REQUIRE(region_of(world).any_embedded());
  const Mat3X<double> rough = 3e-4 * random_displacement(static_cast<Index>(state.u.cols()), 1);
  for (Index v = 0; v < state.u.cols(); ++v)
    if (!world.held().holds(v)) state.u.col(v) = rough.col(v);
  world.set_state(state);
  const double edge = region_of(world).lattice().frame.edge;
  CHECK((world.state().u - state.u).cwiseAbs().maxCoeff() < Fading<double>::least * edge);
}
