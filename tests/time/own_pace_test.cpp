#include "lobe/time/own_pace.h"

#include <doctest/doctest.h>

#include <numeric>

#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Patches in a row, of these frequencies [rad/s], as laid out by pace.
struct Row {
  PatchGraph graph;
  PatchLimits limits;

  explicit Row(const std::vector<double>& omegas, double safety = 0.8) {
    for (std::size_t p = 0; p < omegas.size(); ++p) {
      graph.patches.push_back({1, highest_level, false});
      graph.neighbours.emplace_back();
      if (p > 0) graph.neighbours[p].push_back(Index(p) - 1);
      if (p + 1 < omegas.size()) graph.neighbours[p].push_back(Index(p) + 1);
      limits.squares.push_back(omegas[p] * omegas[p]);
    }
    limits.is_fast.assign(omegas.size(), 0);
    limits.ratios.fill(1);
    limits.safety = safety;
    limits.longest = 2 * safety / *std::max_element(omegas.begin(), omegas.end());
  }
  std::vector<Level> levels(Level top = highest_level) const {
    return levels_of_patches(graph, limits, limits.longest, top);
  }
};

using Levels = std::vector<Level>;

}  // namespace

TEST_CASE("a patch steps as seldom as its frequency allows, and neighbours differ by one level at most") {
  CHECK(Row({8, 8, 8}).levels() == Levels{0, 0, 0});
  CHECK(Row({8, 4, 2, 1}).levels() == Levels{0, 1, 2, 3});
  CHECK(Row({8, 4.1, 2, 1}).levels() == Levels{0, 0, 1, 2});
  CHECK(Row({1, 1, 1, 8, 1}).levels() == Levels{3, 2, 1, 0, 1});
  CHECK(Row({1, 1, 1, 8, 1}).levels(2) == Levels{2, 2, 1, 0, 1});
  Row fast({8, 1, 1, 1});
  fast.limits.is_fast[2] = 1;
  CHECK(fast.levels() == Levels{0, 1, 0, 1});
}

TEST_CASE("patches that are tied step together, with their fastest") {
  Row row({8, 1, 1, 1, 1});
  row.graph.patches[4].is_tied = row.graph.patches[1].is_tied = true;
  CHECK(row.levels() == Levels{0, 1, 2, 2, 1});
  row.graph.patches[1].is_tied = false;
  row.graph.patches[0].is_tied = true;
  CHECK(row.levels() == Levels{0, 1, 2, 1, 0});
}

TEST_CASE("an empty patch holds nobody back") {
  Row row({8, 1, 1});
  row.graph.patches[1].cost = 0;
  row.graph.neighbours = {{}, {}, {}};
  CHECK(row.levels() == Levels{0, 0, 3});
}

TEST_CASE("levels count as stable as long as no step of a patch is too long") {
  const Row row({8, 4, 2});
  const Levels levels = row.levels();
  CHECK(levels == Levels{0, 1, 2});
  const double longest = row.limits.longest;
  CHECK(are_stable(row.graph, row.limits, levels, longest, 0.8));
  CHECK_FALSE(are_stable(row.graph, row.limits, levels, 1.01 * longest, 0.8));
  CHECK(are_stable(row.graph, row.limits, levels, 1.24 * longest, 1));
  PatchLimits stiffer = row.limits;
  stiffer.squares[2] *= 1.7;
  CHECK_FALSE(are_stable(row.graph, stiffer, levels, longest, 1));
  PatchLimits touched = row.limits;
  touched.is_fast[1] = 1;
  CHECK_FALSE(are_stable(row.graph, touched, levels, longest, 1));
}

TEST_CASE("what was measured of a level, and caution above the measured pace, shorten steps") {
  Row row({8, 4, 4});
  row.limits.ratios[1] = 1.01;
  CHECK(row.levels() == Levels{0, 0, 0});
  row.limits.ratios[1] = 1;
  CHECK(row.levels() == Levels{0, 1, 1});
  row.graph.patches[2].pace = 0;
  CHECK(row.levels() == Levels{0, 1, 0});
}

TEST_CASE("the cheapest pace of a frame is chosen") {
  std::vector<double> omegas(32, 1.0);
  SUBCASE("of bodies alike, the one step for all") {
    const Row row(omegas);
    const OwnPace pace = choose_pace(row.graph, row.limits, 80, {});
    CHECK(pace.steps == 80);
    CHECK(pace.levels.empty());
    CHECK(pace.share == 1);
  }
  SUBCASE("shorter steps where these let most of a body take four at once") {
    omegas[0] = 3.6;
    const Row row(omegas);
    const OwnPace pace = choose_pace(row.graph, row.limits, 80, {});
    CHECK(pace.top() == 2);
    CHECK(pace.steps % 4 == 0);
    CHECK(pace.steps >= 89);  // 80 × 4/3.6
    CHECK(pace.steps <= 96);
    CHECK(pace.share == near((1 + 0.5 + 30 * 0.25) / 32, 1e-12));
    CHECK(are_stable(row.graph, row.limits, pace.levels, row.limits.longest * 80 / pace.steps, 0.8));
  }
  SUBCASE("the number of steps is a multiple of the longest one") {
    omegas[0] = 40;
    const Row row(omegas);
    for (int fewest = 1; fewest < 70; ++fewest) {
      const OwnPace pace = choose_pace(row.graph, row.limits, fewest, {});
      CHECK(pace.steps >= fewest);
      CHECK(pace.steps % (1 << pace.top()) == 0);
      CHECK(pace.steps * (pace.share + cost_of_step) <= fewest * (1 + cost_of_step));
    }
    CHECK(choose_pace(row.graph, row.limits, 1, {}).levels.empty());
  }
}

TEST_CASE("present levels are kept where they are stable and nearly as cheap") {
  std::vector<double> omegas(64, 1.0);
  omegas[0] = 4;
  const Row row(omegas);
  const OwnPace pace = choose_pace(row.graph, row.limits, 80, {});
  CHECK(pace.top() == 2);
  Levels present = pace.levels;
  present[63] = 1;
  CHECK(choose_pace(row.graph, row.limits, 80, {present}).levels == present);
  present.assign(64, 1);
  CHECK(choose_pace(row.graph, row.limits, 80, {present}).levels == pace.levels);  // unstable: patch 0
  present.assign(64, 0);
  CHECK(choose_pace(row.graph, row.limits, 80, {present}).levels == pace.levels);
  const Row equal(std::vector<double>(64, 1.0));  // which one step for all suits
  present.assign(64, 0);
  CHECK(choose_pace(equal.graph, equal.limits, 80, {present}).levels.empty());
}

TEST_CASE("levels that gain little are kept, and are not begun with") {
  std::vector<double> omegas(64, 2.2);
  std::fill_n(omegas.begin(), 10, 1.0);
  const Row row(omegas);
  CHECK(choose_pace(row.graph, row.limits, 80, {}).levels.empty());
  const Levels levels = row.levels(1);
  CHECK(choose_pace(row.graph, row.limits, 80, {levels}).levels == levels);
}

TEST_CASE("where there are levels, steps are at most 0.8 of the stable one, and are kept up to 0.818") {
  std::vector<double> omegas(64, 1.0);
  omegas[0] = 4.5;
  const Row row(omegas, 0.9);
  const OwnPace pace = choose_pace(row.graph, row.limits, 850, {});
  REQUIRE(pace.top() == 2);
  CHECK(pace.steps == 960);                                                         // 0.797
  CHECK(choose_pace(row.graph, row.limits, 850, {pace.levels, 936}).steps == 936);  // 0.817
  CHECK(choose_pace(row.graph, row.limits, 850, {pace.levels, 932}).steps == 960);  // 0.821
  const Row equal(std::vector<double>(64, 1.0), 0.9);
  CHECK(choose_pace(equal.graph, equal.limits, 850, {}).steps == 850);
}

TEST_CASE("a pace is kept as long as it is stable and costs less than one step for all") {
  std::vector<double> omegas(64, 1.0);
  omegas[0] = 4;
  const Row row(omegas);
  const Levels levels = choose_pace(row.graph, row.limits, 80, {}).levels;
  const Levels dear = row.levels(1);
  REQUIRE(choose_pace(row.graph, row.limits, 80, {dear, 80}).levels == levels);
  const auto kept = keep_pace(row.graph, row.limits, 80, {dear, 80});
  REQUIRE(kept);
  CHECK(kept->levels == dear);
  CHECK(kept->steps == 80);
  CHECK(kept->share == near((1 + 63 * 0.5) / 64, 1e-12));
  CHECK(keep_pace(row.graph, row.limits, 80, {dear, 81})->steps == 80);  // no whole number of large steps
  CHECK(keep_pace(row.graph, row.limits, 80, {dear, 140})->steps == 140);
  CHECK(keep_pace(row.graph, row.limits, 80, {dear, 160})->steps == 80);  // dearer than one step for all
  Row stiffer = row;
  stiffer.limits.squares[20] = 9;
  CHECK_FALSE(keep_pace(stiffer.graph, stiffer.limits, 80, {dear, 80}));
  const auto together = keep_pace(stiffer.graph, stiffer.limits, 80, {});
  REQUIRE(together);
  CHECK(together->levels.empty());
  CHECK(together->steps == 80);
}

TEST_CASE("the length of steps is kept as well where it is stable") {
  std::vector<double> omegas(64, 1.0);
  omegas[0] = 4;
  const Row row(omegas);
  const Levels levels = choose_pace(row.graph, row.limits, 80, {}).levels;
  CHECK(choose_pace(row.graph, row.limits, 80, {levels, 88}).steps == 88);
  CHECK(choose_pace(row.graph, row.limits, 80, {levels, 76}).steps == 80);   // too long
  CHECK(choose_pace(row.graph, row.limits, 80, {levels, 120}).steps == 80);  // too short
  CHECK(choose_pace(row.graph, row.limits, 80, {levels, 82}).steps == 80);   // 82 are no large steps
}
