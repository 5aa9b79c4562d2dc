// A world of two bodies: which of them a tetrahedron and a triangle belong to stays right through cuts.
#include <doctest/doctest.h>

#include "lobe/mesh/generators.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/sim/checkpoint.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double gap = 0.01;  // [m]

Setup two_boxes() {
  Setup setup;
  TetMesh second = box_mesh({0.06, 0.04, 0.04}, 6, 4, 4);
  append_body(box_mesh({0.06, 0.04, 0.04}, 6, 4, 4), "first", setup.mesh);
  second.points.row(2).array() += 0.04 + gap;
  append_body(second, "second", setup.mesh);
  setup.materials = {{.lambda = 4e4, .mu = 1e4, .density = 1000}};
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.damping = 20;
  return setup;
}

// By height: the second body lies above the first.
template <class Real>
void check_bodies(World<Real>& world) {
  const Elements& elements = world.elements();
  const auto is_above = [&](Index t) {
    return elements.corner_points(t).row(2).minCoeff() >= 0.04 + gap - 1e-9;
  };
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) CHECK(elements.bodies.body_of(t) == int(is_above(t)));
  const SurfaceMesh& surface = world.surface().mesh();
  REQUIRE(surface.body.size() == surface.triangles.size());
  for (Index i = 0; i < surface.triangle_count(); ++i)
    CHECK(surface.body[std::size_t(i)] == int(is_above(surface.owner[std::size_t(i)].tet)));
  CHECK(fault_of(world).empty());
}

}  // namespace

TEST_CASE("tetrahedra and triangles keep their body when a cautery and a blade cut") {
  World<float> world(two_boxes());
  check_bodies(world);
  std::vector<Index> burnt;
  for (Index t = 10; t < world.elements().topology.tet_count(); t += 37) burnt.push_back(t);
  world.remove_tets(burnt);
  check_bodies(world);
  const ToolId id = world.tools().next_id();
  world.apply(BringScalpel{"blade", {{0.031, -0.01, -0.01}, {0.031, -0.01, 0.12}}});
  world.apply(SwitchTool{id, true});
  for (int i = 1; i <= 6; ++i) {  // through both bodies
    world.apply(Lead{id, {Vec3d(0.031, -0.01 + 0.01 * i, -0.01)}});
    CHECK(world.advance(1e-3).ok);
  }
  CHECK(world.grains());
  check_bodies(world);
}

TEST_CASE("the present body as a setup, and a restored world, have the bodies") {
  const Setup setup = two_boxes();
  World<float> world(setup), other(setup);
  world.remove_tets({3, 4, 700});
  other.restore(world.save());
  check_bodies(other);
  CompactMesh compacted;
  const Setup now = world.current_setup(compacted);
  CHECK(now.mesh.bodies.names == setup.mesh.bodies.names);
  REQUIRE(now.mesh.bodies.of.size() == compacted.tet_source.size());
  for (std::size_t t = 0; t < now.mesh.bodies.of.size(); ++t)
    CHECK(now.mesh.bodies.of[t] == setup.mesh.bodies.of[std::size_t(compacted.tet_source[t])]);
}

TEST_CASE("a setup whose bodies do not fit its mesh is refused") {
  Setup setup = two_boxes();
  setup.mesh.bodies.of.pop_back();
  CHECK_THROWS_AS(World<float>{setup}, InputError);
  setup = two_boxes();
  setup.mesh.bodies.of.back() = 2;
  CHECK_THROWS_AS(World<float>{setup}, InputError);
  setup = two_boxes();
  setup.mesh.bodies.names.clear();
  CHECK_THROWS_AS(World<float>{setup}, InputError);
}

TEST_CASE("a checkpoint of other bodies is of another setup") {
  Setup setup = two_boxes();
  const World<float> world(setup);
  setup.mesh.bodies.of.back() = 0;
  World<float> other(setup);
  CHECK_THROWS_AS(other.restore(world.save()), InputError);
}

TEST_CASE("a condition names the body of the tetrahedron that it is about") {
  World<double> world(two_boxes());
  State<double> state = world.state();
  const Index last = world.elements().topology.tet_count() - 1;
  const Eigen::Vector4i corners = world.elements().topology.corners(last);
  const Vec3d way = world.elements().points.col(corners[0]) - world.elements().points.col(corners[1]);
  state.u.col(corners[1]) = 0.999 * way;
  world.set_state(state);
  const Report report = world.advance(1e-4);
  REQUIRE_FALSE(report.conditions.empty());
  CHECK(report.conditions[0].kind == Condition::Kind::near_inversion);
  CHECK(report.conditions[0].text.find(" of \"second\" is at ") != std::string::npos);
}
