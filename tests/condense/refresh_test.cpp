// A region that many cuts have touched is condensed afresh beside the simulation.
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

template <class Real>
Index count(const World<Real>& world, Edit::Kind kind) {
  return static_cast<Index>(std::count_if(world.history().begin(), world.history().end(),
                                          [&](const Edit& edit) { return edit.kind == kind; }));
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
    if (i % 4 == 0 || count(world, Edit::Kind::end_refresh) > ended)
      CHECK(compare_with_rebuilt(world).largest() < 1e-9);
    ended = count(world, Edit::Kind::end_refresh);
  }
  CHECK(count(world, Edit::Kind::begin_refresh) >= 1);
  CHECK(ended >= 1);
}

TEST_CASE("it is taken in the same frame on one and on two threads, and from a checkpoint in between") {
  const Setup setup = cut_body();
  World<float> first(setup, 1), second(setup, 2), third(setup, 1);
  int saved_at = 0;
  const Folder folder;
  for (int i = 0; i < 18; ++i) {
    play(first, setup, i, i + 1);
    const bool in_between =
        count(first, Edit::Kind::begin_refresh) > 0 && count(first, Edit::Kind::end_refresh) == 0;
    if (!in_between || saved_at > 0) continue;
    write_checkpoint(folder.path / "state", first.save());
    saved_at = i + 1;
  }
  play(second, setup, 0, 18);
  CHECK(first.history() == second.history());
  CHECK(first.state().u == second.state().u);
  REQUIRE(saved_at > 0);
  third.restore(read_checkpoint<float>(folder.path / "state"));
  play(third, setup, saved_at, 18);
  CHECK(first.history() == third.history());
  CHECK(first.state().u == third.state().u);
}
