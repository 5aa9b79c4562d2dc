// Incisions and entries of a history that a world cannot follow, as a damaged file may have them.
#include <doctest/doctest.h>

#include "lobe/sim/checkpoint.h"
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
  Hold entry;
  entry.held.hold(item);
  return entry;
}

BeginCondensing about(std::size_t numbers) {
  return {1, std::make_shared<std::vector<double>>(numbers, 0.0)};
}

void check_same_motion(World<double>& world, World<double>& other) {
  REQUIRE(world.advance(0.01).ok);
  other.advance(0.01);
  CHECK(world.state().u == other.state().u);
  CHECK(world.state().v == other.state().v);
}

void restore_with(World<double>& world, const std::vector<JournalEntry>& entries) {
  Checkpoint<double> checkpoint = world.save();
  for (const JournalEntry& entry : entries) checkpoint.history.push_back(entry);
  world.restore(checkpoint);
}

}  // namespace

TEST_CASE("an incision that does not fit the body is refused and changes nothing") {
  const Setup setup = hanging();
  const Index vertices = setup.mesh.vertex_count(), tets = setup.mesh.tet_count();
  const std::string no_point = "incision: names a point that there is not, or divides an edge at its end";
  const std::vector<std::pair<Incision, std::string>> cases = {
      {{{{0, vertices + 1000, 0.5}}, {}, 0}, no_point},
      {{{}, {4 * 100 * tets}, 0}, "incision: opens a face that there is not"},
      {{{{0, 0, 0.5}}, {}, 0}, no_point},
  };
  World<double> world(setup), other(setup);
  for (const auto& [incision, message] : cases) {
    CHECK_THROWS_WITH_AS(incise(world, {incision}), message.c_str(), InputError);
    CHECK(world.journal().edits.empty());
    CHECK(world.grains() == nullptr);
    check_same_motion(world, other);
  }
}

TEST_CASE("a history with an entry that the body cannot follow is refused and changes nothing") {
  const Setup setup = hanging();
  const Index vertices = setup.mesh.vertex_count();
  const auto held = [](Index vertex) {
    return "held vertex " + std::to_string(vertex) +
           ": does not exist, or is held at a place that is not finite or by a share not in (0, 1]";
  };
  const std::vector<std::pair<JournalEntry, std::string>> cases = {
      {hold({.vertex = vertices}), held(vertices)},
      {hold({.vertex = 0, .goal = Vec3d(0, std::nan(""), 0)}), held(0)},
      {about(std::size_t(3 * vertices)),
       "precomputed region: there is none to condense, or it is being condensed already"},
      {EndCondensing{}, "precomputed region: condensing has not begun, so it cannot end"},
  };
  World<double> world(setup), other(setup);
  for (const auto& [entry, message] : cases) {
    CHECK_THROWS_WITH_AS(restore_with(world, {entry}), message.c_str(), InputError);
    CHECK(world.journal().edits.empty());
    CHECK(world.held() == other.held());
    check_same_motion(world, other);
  }
}

TEST_CASE("a pre-computed region is condensed once at a time, about displacements of its mesh") {
  Setup setup = hanging();
  const double middle = setup.mesh.points.row(2).mean();
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).z() > middle) setup.region_of[std::size_t(t)] = RegionModel::precomputed;
  World<double> world(setup);
  REQUIRE(world.body().regions.any_condensed());
  CHECK_THROWS_WITH_AS(restore_with(world, {about(3)}),
                       "precomputed region: cannot be linearised about displacements of another mesh",
                       InputError);
  const BeginCondensing all = about(std::size_t(3 * setup.mesh.vertex_count()));
  CHECK_THROWS_AS(restore_with(world, {all, all}), InputError);
  CHECK_THROWS_AS(restore_with(world, {all, EndCondensing{}, EndCondensing{}}), InputError);
  CHECK_FALSE(world.body().regions.is_condensing());
  restore_with(world, {all});
  CHECK(world.body().regions.is_condensing());
  restore_with(world, {EndCondensing{}});
  CHECK_FALSE(world.body().regions.is_condensing());
  CHECK(world.advance(0.01).ok);
}
