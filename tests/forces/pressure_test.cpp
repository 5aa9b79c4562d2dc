#include "lobe/forces/pressure.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "lobe/error.h"
#include "lobe/mesh/outer_faces.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup pressed_box(double pressure) {
  Setup setup = setup_of(irregular_box(3));
  for (const TetFace& face : outer_faces(setup.mesh))
    setup.pressures.push_back({face.tet, face.face, pressure});
  return setup;
}

Mat3X<double> some_displacements(const Setup& setup) {
  Mat3X<double> u(3, setup.mesh.vertex_count());
  for (Index v = 0; v < u.cols(); ++v)
    for (int i = 0; i < 3; ++i) u(i, v) = 0.004 * std::sin(3.0 * v + 2.0 * i);
  return u;
}

double volume_at(const Setup& setup, const Mat3X<double>& u) {
  TetMesh mesh = setup.mesh;
  mesh.points += u;
  double sum = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) sum += signed_volume(tet_points(mesh, t));
  return sum;
}

}  // namespace

TEST_CASE(
    "pressure on a closed surface is the derivative of the volume, and neither moves nor turns the body") {
  const Setup setup = pressed_box(120);
  const Elements elements(setup);
  const Mat3X<double> u = some_displacements(setup);
  Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
  add_pressures(setup.pressures, elements, 1, u, f);
  CHECK(f.rowwise().sum().norm() < 1e-14 * f.norm());
  Vec3d torque = Vec3d::Zero();
  for (Index v = 0; v < u.cols(); ++v) torque += (setup.mesh.points.col(v) + u.col(v)).cross(f.col(v));
  CHECK(torque.norm() < 1e-14 * f.norm());
  constexpr double h = 1e-6;
  for (Index v = 0; v < u.cols(); v += 5)
    for (int i = 0; i < 3; ++i) {
      Mat3X<double> more = u, less = u;
      more(i, v) += h;
      less(i, v) -= h;
      const double slope = (volume_at(setup, more) - volume_at(setup, less)) / (2 * h);
      CHECK(f(i, v) == near(-120 * slope, 1e-6, 0.01));
    }
}

TEST_CASE("pressure grows over the ramp, and faces of removed tetrahedra lose it") {
  Setup setup = pressed_box(50);
  setup.load_ramp = 0.2;
  Pressure<double> term(setup);
  Model model{Elements(setup), {}, {}};
  const Mat3X<double> u = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
  const auto force_at = [&](double time) {
    Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
    term.add_forces({model, u, u, time}, f);
    return f.norm();
  };
  CHECK(force_at(0) == 0);
  CHECK(force_at(0.05) == near(force_at(1) / 4, 1e-12));
  CHECK(force_at(0.2) == force_at(1));
  const std::size_t before = term.acts_on(model).size();
  const std::vector<Index> first{setup.pressures[0].tet};
  const MeshEdit edit = model.elements.topology.remove(first);
  term.follow(model.elements.topology, edit);
  CHECK(term.acts_on(model).size() < before);
  Pressure<double> read(pressed_box(1));
  read.load(term.save(), setup.mesh.vertex_count());
  CHECK(read.save() == term.save());
}

TEST_CASE("a body under pressure that was cut before its first frame equals one that is built afresh") {
  Setup setup = pressed_box(40);
  setup.damping = 20;
  World<double> world(setup);
  world.apply(RemoveTets{{0, 7}});
  for (int i = 0; i < 5; ++i) REQUIRE(world.advance(0.01).ok);
  world.apply(RemoveTets{{12}});
  const RebuildDifference difference = compare_with_rebuilt(world);
  CHECK(difference.force < 1e-9);
  CHECK(difference.largest() < 1e-6);
  World<double> other(setup);
  other.restore(world.save());
  REQUIRE(world.advance(0.01).ok);
  REQUIRE(other.advance(0.01).ok);
  CHECK(other.state().u == world.state().u);
  Checkpoint<double> damaged = world.save();
  REQUIRE(damaged.terms.size() == 1);
  Setup elsewhere = setup;
  elsewhere.pressures[0].tet = setup.mesh.tet_count();
  damaged.terms[0].saved = Pressure<double>(elsewhere).save();
  CHECK_THROWS_AS(other.restore(damaged), InputError);
  CHECK(other.state().u == world.state().u);
}
