#include "lobe/lattice/settle.h"

#include <doctest/doctest.h>

#include "lattice_support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("a lattice takes over a linear field exactly, and conserves the momentum of any other") {
  EmbeddedBox box;
  const std::vector<double> mass = box.vertex_masses();
  const std::vector<std::uint8_t> all(std::size_t(box.lattice.node_count()), 1);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> linear = affine_displacement(box.setup.mesh.points, F);
  Mat3X<double> q = Mat3X<double>::Zero(3, box.lattice.node_count());
  settle(box.elements, box.lattice, box.embedding, box.embedding.cells, mass, 1000, all, linear, 1e-24, q);
  CHECK((q - affine_displacement(box.lattice.nodes, F)).cwiseAbs().maxCoeff() <
        1e-10 * linear.cwiseAbs().maxCoeff());

  const Mat3X<double> rough = random_displacement(box.setup.mesh.vertex_count(), 1);
  settle(box.elements, box.lattice, box.embedding, box.embedding.cells, mass, 1000, all, rough, 1e-24, q);
  const Mat3X<double> taken = interpolated(box, q);
  Vec3d before = Vec3d::Zero(), after = before, spin_before = before, spin_after = before;
  double size = 0;
  for (Index v = 0; v < rough.cols(); ++v) {
    const double m = mass[std::size_t(v)];
    const Vec3d X = box.setup.mesh.points.col(v);
    before += m * rough.col(v);
    after += m * taken.col(v);
    spin_before += m * X.cross(Vec3d(rough.col(v)));
    spin_after += m * X.cross(Vec3d(taken.col(v)));
    size += m * rough.col(v).norm();
  }
  CHECK((before - after).norm() < 1e-9 * size);
  CHECK((spin_before - spin_after).norm() < 1e-9 * size * 0.08);
  CHECK((taken - rough).norm() > 0.1 * rough.norm());
}

TEST_CASE("nodes that are not touched stay as they are") {
  EmbeddedBox box;
  const std::vector<double> mass = box.vertex_masses();
  std::vector<std::uint8_t> some(std::size_t(box.lattice.node_count()), 0);
  some[10] = some[11] = 1;
  const Mat3X<double> before = random_displacement(box.lattice.node_count(), 1);
  Mat3X<double> q = before;
  settle(box.elements, box.lattice, box.embedding, box.embedding.cells, mass, 1000, some,
         random_displacement(box.setup.mesh.vertex_count(), 1), 1e-24, q);
  for (Index n = 0; n < q.cols(); ++n) CHECK((q.col(n) == before.col(n)) == (n != 10 && n != 11));
}

TEST_CASE("a rigid motion gives moving masses any momentum that is asked for") {
  MovingMasses masses, moved;
  const Mat3X<double> x = random_displacement(9, 1), v = random_displacement(9, 1, 3);
  const MovingMasses::Momentum wanted{{1, -2, 3}, {0.5, 4, -1}};
  for (Index i = 0; i < 9; ++i) masses.add(1.0 + double(i), x.col(i), v.col(i));
  const auto motion = masses.moved_by(wanted - masses.momentum());
  for (Index i = 0; i < 9; ++i) moved.add(1.0 + double(i), x.col(i), v.col(i) + motion(Vec3d(x.col(i))));
  CHECK((moved.momentum().linear - wanted.linear).norm() < 1e-12);
  CHECK((moved.momentum().angular - wanted.angular).norm() < 1e-12);
}

TEST_CASE("masses in a line take the momentum that they can") {
  MovingMasses masses;
  for (int i = 0; i < 3; ++i) masses.add(1, Vec3d(i, 0, 0), Vec3d::Zero());
  const auto motion = masses.moved_by({{3, 0, 0}, {5, 0, 2}});
  CHECK(motion.velocity == Vec3d(1, 0, 0));
  CHECK(motion.spin.x() == 0);
  CHECK(motion.spin.z() == near(1, 1e-12));
  CHECK(MovingMasses().moved_by({{1, 0, 0}, {0, 0, 0}}).velocity.isZero(0));
}
