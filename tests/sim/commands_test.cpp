// Commands that a world cannot follow, as a damaged file or an application may have them.
#include <doctest/doctest.h>

#include "lobe/sim/world.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A box that hangs from its top.
Setup hanging() {
  Setup setup = setup_of(irregular_box(3));
  const double top = setup.mesh.points.row(2).maxCoeff();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) > top - 1e-6) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -9.81};
  return setup;
}

Hold hold(const HeldVertices::Held& item) {
  Hold command;
  command.held.hold(item);
  return command;
}

BeginCondensing about(std::size_t numbers) {
  return {1, std::make_shared<std::vector<double>>(numbers, 0.0)};
}

}  // namespace

TEST_CASE("a command that a world cannot follow is refused by name and changes nothing") {
  const Setup setup = hanging();
  const Index vertices = setup.mesh.vertex_count(), tets = setup.mesh.tet_count();
  Incise no_point, no_face, edge_twice;
  no_point.incisions = {{{{0, vertices + 1000, 0.5}}, {}, 0}};
  no_face.incisions = {{{}, {4 * 100 * tets}, 0}};
  edge_twice.incisions = {{{{0, 0, 0.5}}, {}, 0}};
  const std::vector<std::pair<Command, std::string>> cases = {
      {hold({.vertex = vertices}), "command: holds a vertex that there is not, or at no finite place"},
      {hold({.vertex = 0, .goal = Vec3d(0, std::nan(""), 0)}),
       "command: holds a vertex that there is not, or at no finite place"},
      {about(std::size_t(3 * vertices)),
       "command: condenses a region that there is not, or that is being condensed"},
      {EndCondensing{}, "command: ends condensing, which has not begun"},
      {no_point, "incision: names a point that there is not, or divides an edge at its end"},
      {no_face, "incision: opens a face that there is not"},
      {edge_twice, "incision: names a point that there is not, or divides an edge at its end"},
  };
  World<double> world(setup), other(setup);
  for (const auto& [command, message] : cases) {
    CAPTURE(message);
    CHECK_THROWS_WITH_AS(world.apply(command), message.c_str(), InputError);
    CHECK(world.journal().edits.empty());
    CHECK(world.grains() == nullptr);
    CHECK(world.held() == other.held());
    REQUIRE(world.advance(0.01).ok);
    other.advance(0.01);
    CHECK(world.state().u == other.state().u);
    CHECK(world.state().v == other.state().v);
  }
}

TEST_CASE("a pre-computed region is condensed once at a time, about displacements of its mesh") {
  Setup setup = hanging();
  const double middle = setup.mesh.points.row(2).mean();
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).z() > middle) setup.region_of[std::size_t(t)] = RegionModel::precomputed;
  World<double> world(setup);
  REQUIRE(world.body().regions.any_condensed());
  CHECK_THROWS_WITH_AS(world.apply(about(3)), "command: relinearises about displacements of another mesh",
                       InputError);
  const auto all = std::size_t(3 * setup.mesh.vertex_count());
  world.apply(about(all));
  CHECK(world.body().regions.is_condensing());
  CHECK_THROWS_AS(world.apply(about(all)), InputError);
  world.apply(EndCondensing{});
  CHECK_FALSE(world.body().regions.is_condensing());
  CHECK_THROWS_AS(world.apply(EndCondensing{}), InputError);
  CHECK(world.advance(0.01).ok);
}
