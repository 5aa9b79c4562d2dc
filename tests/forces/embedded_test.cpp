#include "lobe/forces/embedded.h"

#include <doctest/doctest.h>

#include <memory>
#include <set>

#include "lobe/forces/force_term.h"
#include "lobe/scalpel/grains.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A term without forces that remembers the edits of the mesh.
struct Listener : ForceTerm<double> {
  std::string name() const override { return "listener"; }
  void add_forces(const At&, Mat3X<double>&) override {}
  std::vector<Index> acts_on(const Model&) const override { return {}; }
  void follow(const Topology&, const MeshEdit& edit) override { edits.push_back(edit); }
  std::vector<MeshEdit> edits;
};

// A bar along x, held where x is least, and a blade that falls through its middle at x = 63 mm.
Setup bar_and_blade() {
  Setup setup = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v});
  setup.damping = 5;
  setup.scalpels.push_back({"blade",
                            0.1,
                            {{0, {0.063, -0.02, 0.05}}, {0.1, {0.063, -0.02, -0.03}}},
                            {{0.063, 0.05, 0.05}, {0.063, 0.05, -0.03}}});
  return setup;
}

}  // namespace

TEST_CASE("an embedded point lies where it was put, and moves with an affine motion of the body") {
  const Setup setup = setup_of(irregular_box(4));
  const Elements elements(setup);
  const Locator locator(setup.mesh);
  const Vec3d X(0.0123, 0.0171, 0.0222);
  const FoundPoint found = embed(locator, X);
  CHECK(found.distance == 0);
  CHECK(found.point.is_valid());
  CHECK((rest_position(found.point, elements) - X).norm() < 1e-16);
  Mat3<double> F;
  F << 1.2, 0.1, 0, -0.3, 0.9, 0.2, 0, 0.4, 1.1;
  const Mat3X<double> u = affine_displacement(setup.mesh.points, F);
  CHECK((position(found.point, elements, u) - F * X).norm() < 1e-16);
}

TEST_CASE("a point outside of a mesh is embedded on its surface, and says how far away it is") {
  const Setup setup = setup_of(box_mesh(Vec3d::Constant(0.04), 4, 4, 4));
  const Elements elements(setup);
  const FoundPoint found = embed(Locator(setup.mesh), Vec3d(0.017, 0.022, 0.043));
  CHECK(found.distance == near(0.003, 1e-12));
  CHECK(found.point.is_valid());
  CHECK(found.point.weights.minCoeff() >= 0);
}

TEST_CASE("a force on an embedded point keeps its sum, its moment and its work") {
  const Setup setup = setup_of(irregular_box(4));
  const Elements elements(setup);
  const EmbeddedPoint point = embed(Locator(setup.mesh), Vec3d(0.0123, 0.0171, 0.0222)).point;
  const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 1e-3),
                      du = random_displacement(setup.mesh.vertex_count(), 1e-3, 9);
  const Vec3d force(1, -2, 3);
  Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
  add_force(point, elements.topology, force, f);
  CHECK((f.rowwise().sum() - force).norm() < 1e-15 * force.norm());
  Vec3d moment = Vec3d::Zero();
  for (Index v = 0; v < f.cols(); ++v)
    moment += Vec3d(setup.mesh.points.col(v) + u.col(v)).cross(Vec3d(f.col(v)));
  const Vec3d expected = position(point, elements, u).cross(force);
  CHECK((moment - expected).norm() < 1e-14 * expected.norm());
  const Vec3d moved = position(point, elements, Mat3X<double>(u + du)) - position(point, elements, u);
  CHECK(f.cwiseProduct(du).sum() == near(force.dot(moved), 1e-12));
}

TEST_CASE("a point ends with its tetrahedron") {
  const Setup setup = setup_of(irregular_box(4));
  World<double> world(setup);
  const EmbeddedPoint point = embed(Locator(setup.mesh), Vec3d(0.0123, 0.0171, 0.0222)).point;
  CHECK(exists(point, world.elements().topology));
  world.remove_tets({point.tet});
  CHECK_FALSE(exists(point, world.elements().topology));
  CHECK_FALSE(exists({}, world.elements().topology));
}

TEST_CASE("points in tetrahedra that a blade divides go with the side that they lie on") {
  const Setup setup = bar_and_blade();
  World<double> world(setup);
  const auto listener = std::make_shared<Listener>();
  world.add(listener);
  const Locator locator(setup.mesh);
  std::vector<EmbeddedPoint> points;
  for (double x = 0.0605; x < 0.07; x += 0.001)
    for (double y = 0.0015; y < 0.03; y += 0.003)
      for (double z = 0.0017; z < 0.03; z += 0.003) points.push_back(embed(locator, {x, y, z}).point);
  for (int frame = 0; frame < 8; ++frame) {
    const std::size_t before = listener->edits.size();
    world.advance(0.025);
    for (std::size_t i = before; i < listener->edits.size(); ++i)
      for (EmbeddedPoint& point : points)
        follow_division(point, world.elements(), *world.grains(), listener->edits[i]);
  }
  const Topology& topology = world.elements().topology;
  REQUIRE(topology.tet_copy_count() > 10);
  const std::vector<std::vector<Index>> pieces = topology.pieces();
  REQUIRE(pieces.size() == 2);
  const std::set<Index> held(pieces[0].begin(), pieces[0].end());
  int on_copies = 0;
  for (const EmbeddedPoint& point : points) {
    REQUIRE(exists(point, topology));
    on_copies += point.tet >= setup.mesh.tet_count();
    const double x = rest_position(point, world.elements()).x();
    CHECK(held.contains(point.tet) == (x < 0.063));
  }
  CHECK(on_copies > 10);
}

TEST_CASE("a point that moves through tissue keeps its place, and ends at the surface") {
  const Setup setup = setup_of(irregular_box(4));
  const Elements elements(setup);
  const EmbeddedPoint start = embed(Locator(setup.mesh), Vec3d(0.0123, 0.0171, 0.0222)).point;
  const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 5e-4);
  const Vec3d from = position(start, elements, u), way(0.015, -0.004, 0.006);
  EmbeddedPoint point = start;
  for (int step = 1; step <= 30; ++step) {
    const Vec3d x = from + step / 30.0 * way;
    point = moved_through(point, x, elements, nullptr, u);
    REQUIRE(point.tet >= 0);
    CHECK(point.weights.minCoeff() >= -1e-12);
    CHECK((position(point, elements, u) - x).norm() < 1e-14);
  }
  CHECK(point.tet != start.tet);
  CHECK(moved_through(start, Vec3d(from + Vec3d(0, 0, 0.1)), elements, nullptr, u).tet == -1);
}

TEST_CASE("a point that moves through tissue ends at the face of a cut") {
  const Setup setup = bar_and_blade();
  World<double> world(setup);
  const auto listener = std::make_shared<Listener>();
  world.add(listener);
  EmbeddedPoint point = embed(Locator(setup.mesh), {0.05, 0.0151, 0.0147}).point;
  for (int frame = 0; frame < 8; ++frame) world.advance(0.025);
  const Mat3X<double> u = Mat3X<double>::Zero(3, world.elements().topology.vertex_count());
  double reached = 0;
  for (double x = 0.0501; x < 0.07; x += 1e-4) {
    point = moved_through(point, {x, 0.0151, 0.0147}, world.elements(), world.grains(), u);
    if (point.tet < 0) break;
    reached = x;
  }
  CHECK(point.tet == -1);
  CHECK(reached == near(0.063, 1.1e-4, 1.0));
}
