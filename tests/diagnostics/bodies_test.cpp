// Energies and overlaps of bodies.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "lobe/diagnostics/body_figures.h"
#include "lobe/diagnostics/body_overlap.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/joined_mesh.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Two boxes along x with a gap between them; negative: they overlap.
TetMesh boxes(double gap) {
  TetMesh mesh, second = box_mesh({0.1, 0.08, 0.06}, 4, 3, 2);
  append_body(box_mesh({0.1, 0.08, 0.06}, 3, 3, 3), "first", mesh);
  second.points.row(0).array() += 0.1 + gap;
  append_body(second, "second", mesh);
  return mesh;
}

Setup two_materials(const TetMesh& mesh) {
  Setup setup;
  setup.mesh = mesh;
  setup.materials = {{.lambda = 4e4, .mu = 1e4, .density = 1000},
                     {.lambda = 8e4, .mu = 3e4, .density = 1200}};
  for (Index t = 0; t < mesh.tet_count(); ++t)
    setup.material_of.push_back(std::uint16_t(mesh.bodies.body_of(t)));
  setup.region_of.assign(std::size_t(mesh.tet_count()), RegionModel::nonlinear);
  return setup;
}

}  // namespace

TEST_CASE("energies of bodies add up to those of the world, also after a cut") {
  Setup setup = two_materials(boxes(0.01));
  SUBCASE("plain") {}
  SUBCASE("edge-smoothed, one of them with nodal pressure") {
    for (Elastic& elastic : setup.materials) elastic.element = ElementType::edge_smoothed;
    setup.materials[1].nodal_pressure = 1;
    setup.volume_penalty = 1e5;
  }
  SUBCASE("one of them edge-smoothed and half linear") {
    setup.materials[0].element = ElementType::edge_smoothed;
    for (std::size_t t = 0; t < 40; ++t) setup.region_of[t] = RegionModel::tensor_mass;
  }
  World<double> world(setup);
  world.apply(RemoveTets{{0, 5, 200}});
  const Index vertices = world.elements().topology.vertex_count();
  State<double> state = world.state();
  state.u = random_displacement(vertices, 1e-3);
  state.v = random_displacement(vertices, 0.1);
  world.set_state(state);
  const std::vector<BodyFigures> bodies = body_figures(world.elements(), state.u, state.v);
  REQUIRE(bodies.size() == 2);
  const Energies energies = world.energies();
  CHECK(bodies[0].name == "first");
  CHECK(bodies[0].tets + bodies[1].tets == world.elements().topology.alive_count());
  CHECK(bodies[0].elastic + bodies[1].elastic == near(energies.elastic(), 1e-12));
  CHECK(bodies[0].elastic > 0);
  CHECK(bodies[1].elastic > bodies[0].elastic);
  double kinetic = 0;
  for (Index v = 0; v < vertices; ++v)
    kinetic += lumped_mass(world.elements(), v) * state.v.col(v).squaredNorm() / 2;
  CHECK(bodies[0].kinetic + bodies[1].kinetic == near(kinetic, 1e-12));
}

TEST_CASE("a body that moves as a whole has its mass, volume, place and momentum") {
  const TetMesh mesh = boxes(0.01);
  const Elements elements(two_materials(mesh));
  Mat3X<double> u = Mat3X<double>::Zero(3, mesh.vertex_count()), v = u;
  const Index first = mesh_of_body(mesh, 0).vertex_count();
  u.rightCols(mesh.vertex_count() - first).colwise() = Vec3d(1, 2, 3);
  v.rightCols(mesh.vertex_count() - first).colwise() = Vec3d(0, 0, 0.5);
  const std::vector<BodyFigures> bodies = body_figures(elements, u, v);
  CHECK(bodies[0].kinetic == 0);
  CHECK(bodies[1].mass == near(1200 * 0.1 * 0.08 * 0.06, 1e-12));
  CHECK(bodies[1].volume == near(0.1 * 0.08 * 0.06, 1e-9));
  CHECK(bodies[1].elastic < 1e-20);
  CHECK((bodies[1].centre - Vec3d(1.16, 2.04, 3.03)).norm() < 1e-12);
  CHECK((bodies[1].momentum - bodies[1].mass * Vec3d(0, 0, 0.5)).norm() < 1e-12);
  CHECK(body_figures(Elements(two_materials(mesh_of_body(mesh, 0))), u, v).empty());
}

TEST_CASE("an overlap has the depth and the place of its deepest point") {
  const std::vector<BodyOverlap> found = body_overlaps(boxes(-0.01));
  REQUIRE(found.size() == 1);
  CHECK(found[0].body == 0);
  CHECK(found[0].other == 1);
  CHECK(found[0].depth == near(0.01, 1e-9));
  CHECK(found[0].place.x() > 0.0899);
  CHECK(found[0].place.x() < 0.1001);
}

TEST_CASE("bodies that touch along a whole face, in any position, do not overlap") {
  for (double angle : {0.0, 0.3, 1.1}) {
    TetMesh mesh = boxes(0);
    const Eigen::AngleAxisd turn(angle, Vec3d(1, 2, 3).normalized());
    mesh.points = (turn.toRotationMatrix() * mesh.points).colwise() + Vec3d(0.3, -0.2, 0.1);
    CHECK(body_overlaps(mesh).empty());
  }
  CHECK(body_overlaps(boxes(0.01)).empty());
}

TEST_CASE("a body within another is as deep as its farthest point from the wall") {
  TetMesh mesh, small = box_mesh({0.02, 0.02, 0.02}, 1, 1, 1);
  append_body(box_mesh({0.1, 0.1, 0.1}, 4, 4, 4), "outer", mesh);
  small.points.colwise() += Vec3d(0.03, 0.04, 0.04);
  append_body(small, "inner", mesh);
  const std::vector<BodyOverlap> found = body_overlaps(mesh);
  REQUIRE(found.size() == 1);
  CHECK(found[0].depth == near(0.05, 1e-9));
}
