// A region that many cuts have touched is condensed afresh beside the simulation, and at once where they have
// made it inexact.
#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "condense/half_linear.h"
#include "folder.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame = 0.1;  // [s]

// What is cut at the start of a frame: some of the linear half, at random.
std::vector<Index> cut_of(const Setup& setup, int at) {
  std::vector<Index> order(std::size_t(setup.mesh.tet_count()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  std::erase_if(order, [&](Index t) { return setup.region_of[std::size_t(t)] != RegionModel::precomputed; });
  order.resize(std::size_t(at) * 40 + 40);
  return {order.end() - 40, order.end()};
}

Setup cut_body() {
  Setup setup = half_linear(RegionModel::precomputed, 8);
  load(setup);
  setup.damping = 30;
  return setup;
}

// A bar, held at one end, of which the half there is precomputed.
Setup bar() {
  Setup setup = hybrid_setup(box_mesh({0.16, 0.03, 0.03}, 16, 3, 3));
  for (RegionModel& region : setup.region_of)
    if (region == RegionModel::tensor_mass) region = RegionModel::precomputed;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  load(setup);
  setup.damping = 30;
  return setup;
}

// All tetrahedra at random, a fiftieth at a time: rags come to hang by a vertex or two.
std::vector<std::vector<Index>> cuts_to_rags(const Setup& setup) {
  std::vector<Index> order(std::size_t(setup.mesh.tet_count()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  std::vector<std::vector<Index>> cuts(50);
  for (std::size_t i = 0; i < order.size(); ++i) cuts[50 * i / order.size()].push_back(order[i]);
  return cuts;
}

template <class Kind, class Real>
Index count(World<Real>& world) {
  return static_cast<Index>(
      std::count_if(world.journal().edits.begin(), world.journal().edits.end(),
                    [](const JournalEntry& entry) { return std::holds_alternative<Kind>(entry); }));
}

template <class Real>
void play(World<Real>& world, const Setup& setup, int from, int to) {
  for (int i = from; i < to; ++i) {
    world.remove_tets(cut_of(setup, i));
    REQUIRE(world.advance(frame).ok);
  }
}

}  // namespace

TEST_CASE(
    "a region is condensed afresh while it is cut, and stays what would be condensed from the cut mesh") {
  const Setup setup = cut_body();
  World<double> world(setup);
  Index ended = 0;
  for (int i = 0; i < 18; ++i) {
    CAPTURE(i);
    world.remove_tets(cut_of(setup, i));
    REQUIRE(world.advance(frame).ok);
    if (i % 4 == 0 || count<EndCondensing>(world) > ended)
      CHECK(compare_with_rebuilt(world).largest() < 1e-9);
    ended = count<EndCondensing>(world);
  }
  CHECK(count<BeginCondensing>(world) >= 1);
  CHECK(ended >= 1);
}

TEST_CASE("it is taken in the same frame on one, two and seven threads, and from a checkpoint in between") {
  const Setup setup = cut_body();
  World<float> first(setup, 1), second(setup, 2), third(setup, 7);
  int saved_at = 0;
  const Folder folder;
  for (int i = 0; i < 18; ++i) {
    play(first, setup, i, i + 1);
    const bool in_between = count<BeginCondensing>(first) > 0 && count<EndCondensing>(first) == 0;
    if (!in_between || saved_at > 0) continue;
    write_checkpoint(folder.path / "state", first.save());
    saved_at = i + 1;
  }
  play(second, setup, 0, 18);
  CHECK(first.journal().edits == second.journal().edits);
  CHECK(first.state().u == second.state().u);
  REQUIRE(saved_at > 0);
  third.restore(read_checkpoint<float>(folder.path / "state"));
  play(third, setup, saved_at, 18);
  CHECK(first.journal().edits == third.journal().edits);
  CHECK(first.state().u == third.state().u);
}

TEST_CASE("a renewal that another has replaced is forgotten, and a world that is restored moves as before") {
  const Setup setup = cut_body();
  World<double> world(setup), restored(setup, 2);
  for (int i = 0; i < 6; ++i) {
    play(world, setup, i, i + 1);
    world.apply(Relinearise{0.5 * frame});
    REQUIRE(world.advance(frame).ok);  // it begins with the next frame
    REQUIRE(world.advance(frame).ok);
  }
  CHECK(count<Superseded>(world) == 2 * 5);
  CHECK(count<BeginCondensing>(world) == 1);
  CHECK(count<EndCondensing>(world) == 1);
  restored.restore(world.save());
  CHECK(restored.journal().edits == world.journal().edits);
  play(world, setup, 6, 9);
  play(restored, setup, 6, 9);
  CHECK(restored.state().u == world.state().u);
  CHECK(restored.journal().edits == world.journal().edits);
}

TEST_CASE("a restored world goes on with the same bits where somebody held before the region was refreshed") {
  const Setup setup = cut_body();
  const std::vector<Index> linear = cut_of(setup, 12);
  World<double> world(setup), restored(setup, 2);
  for (int i = 0; i < 4; ++i) {
    const ToolId hand = world.tools().next_id();
    const Eigen::Vector4i corners = world.elements().topology.corners(linear[std::size_t(i)]);
    world.apply(TakeHold{"hand", {corners.begin(), corners.end()}});
    play(world, setup, i, i + 1);
    if (i % 2 == 0) world.apply(LetGo{hand});
  }
  REQUIRE(count<Hold>(world) > 2);
  world.apply(Relinearise{0.5 * frame});
  while (world.body().regions.is_condensing()) REQUIRE(world.advance(frame).ok);
  REQUIRE(count<EndCondensing>(world) > 0);
  restored.restore(world.save());
  CHECK(restored.state().u == world.state().u);
  play(world, setup, 4, 7);
  play(restored, setup, 4, 7);
  CHECK(restored.state().u == world.state().u);
}

TEST_CASE("a region that is cut to rags stays what would be condensed from the cut mesh") {
  for (const RegionFrame frame_kind : {RegionFrame::fixed, RegionFrame::corotated}) {
    CAPTURE(frame_kind == RegionFrame::corotated);
    Setup setup = bar();
    setup.precomputed_frame = frame_kind;
    World<double> world(setup);
    for (const std::vector<Index>& cut : cuts_to_rags(setup)) {
      world.remove_tets(cut);
      CHECK(compare_with_rebuilt(world).largest() < 1e-9);
    }
    CHECK(world.elements().topology.alive_count() == 0);
  }
}

TEST_CASE("rags move the same on one, two and seven threads, and from a checkpoint at any time") {
  const Setup setup = bar();
  const auto cuts = cuts_to_rags(setup);
  const auto play_on = [&](World<float>& world, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      world.remove_tets(cuts[i]);
      REQUIRE(world.advance(0.002).ok);
    }
  };
  const auto finish =
      [&](World<float>& world) {  // until what another thread has condensed meanwhile takes over
        while (world.body().regions.is_condensing()) REQUIRE(world.advance(frame).ok);
      };
  const std::size_t all = cuts.size();
  World<float> first(setup, 1), second(setup, 2);
  std::vector<std::pair<std::size_t, Checkpoint<float>>> saved;
  for (const std::size_t i : {std::size_t(15), std::size_t(35), all}) {
    play_on(first, saved.empty() ? 0 : saved.back().first, i);
    CHECK(first.body().regions.is_condensing());
    saved.emplace_back(i, first.save());
  }
  finish(first);
  saved.emplace_back(all, first.save());
  play_on(second, 0, all);
  finish(second);
  CHECK(first.journal().edits == second.journal().edits);
  CHECK(first.state().u == second.state().u);
  for (const auto& [at, checkpoint] : saved) {
    CAPTURE(at);
    World<float> restored(setup, 7);
    restored.restore(checkpoint);
    play_on(restored, at, all);
    finish(restored);
    CHECK(restored.journal().edits == first.journal().edits);
    CHECK(restored.state().u == first.state().u);
  }
}
