// Recordings have what blades have cut. A replay cuts the same, wherever it takes the blades to be.
#include <doctest/doctest.h>

#include <random>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/file/scanner.h"
#include "lobe/file/sealed_file.h"
#include "lobe/run/recording.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "recorded_strokes.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Two blades in hands come down through the block, one after the other, so that their cuts cross.
Recording two_strokes(const Setup& setup) {
  World<float> world(setup);
  CommandRecorder<float> recorded(world);
  for (const Vec3d& along : {Vec3d(0.003, 0.08, 0), Vec3d(0.08, -0.004, 0.002)}) {
    const Vec3d tip = Vec3d(0.0237, 0.0263, 0.06) - along / 2;
    const ToolId blade = world.tools().next_id();
    recorded.apply(BringScalpel{"blade", {tip, tip + along}});
    recorded.apply(SwitchTool{blade, true});
    for (int i = 1; i <= 8; ++i) {
      recorded.apply(Lead{blade, {tip - Vec3d(0, 0.0005 * i, 0.006 * i)}});
      REQUIRE(recorded.advance(frame).ok);
    }
    recorded.apply(LetGo{blade});
  }
  REQUIRE(recorded.advance(frame).ok);
  REQUIRE(world.elements().topology.tet_copy_count() > 50);
  return recorded.recording();
}

void check_that_it_replays(const Recording& recording, const Setup& setup, int threads = 1) {
  World<float> world(setup, threads);
  const ReplayResult replayed = replay(recording, world);
  CHECK(replayed.same);
  CHECK(replayed.commands == recording.commands.size());
  validate(world);
}

// The first frame of a recording in which a blade has divided edges and opened faces, as a place in its list.
std::size_t first_cut(const Recording& recording) {
  const std::vector<RecordedCommand> entries = recording.commands.all();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Advance* advance = part<const Advance>(entries[i]);
    if (!advance || advance->cuts.empty()) continue;
    const Incision& incision = advance->cuts[0].steps.back().incision;
    if (!incision.bisections.empty() && !incision.opened.empty()) return i;
  }
  FAIL("nothing was cut");
  return 0;
}

World<float> world_before(std::size_t entry, Recording recording, const Setup& setup) {
  World<float> world(setup);
  std::vector<RecordedCommand> entries = recording.commands.all();
  entries.resize(entry);
  recording.commands = CommandLog(entries);
  REQUIRE(replay(recording, world).same);
  return world;
}

void check_the_rest(World<float>& world, const Recording& recording, std::size_t from) {
  const std::vector<RecordedCommand> entries = recording.commands.all();
  for (std::size_t i = from; i < entries.size(); ++i) {
    world.apply(std::get<Command>(entries[i].command));
    REQUIRE(digest(world) == entries[i].digest);
  }
}

}  // namespace

TEST_CASE("a replay cuts what was recorded, also where its blades are far from the body") {
  const Setup setup = sinking_block();
  const Recording recording = two_strokes(setup);
  for (const int threads : {1, 2}) check_that_it_replays(recording, setup, threads);
  for (const Vec3d& by : {Vec3d(0.004, 0, 0), Vec3d(1, 0, 0)}) {
    const Recording elsewhere = displaced(recording, by);
    check_that_it_replays(elsewhere, setup);
    World<float> world(setup);  // there the blades would cut something else, or nothing
    CHECK_FALSE(replay(without_cuts(elsewhere), world).same);
  }
}

TEST_CASE("blades decide in a replay as they did in the recorded run, where it has no cuts") {
  const Setup setup = sinking_block();
  check_that_it_replays(without_cuts(two_strokes(setup)), setup);
}

TEST_CASE("what was cut in a region of any model is replayed") {
  for (const RegionModel model : {RegionModel::tensor_mass, RegionModel::precomputed}) {
    const Setup setup = sinking_block(model);
    check_that_it_replays(displaced(two_strokes(setup), {1, 0, 0}), setup);
  }
  Setup along_faces = sinking_block();
  along_faces.scalpels = {{"blade",
                           0.1,
                           {{0.01, {0.0237, -0.02, 0.06}}, {0.15, {0.0263, -0.02, 0.01}}},
                           {{0.0237, 0.07, 0.06}, {0.0263, 0.07, 0.01}},
                           true}};
  World<float> world(along_faces);
  CommandRecorder<float> recorded(world);
  for (int i = 0; i < 12; ++i) recorded.advance(frame);
  CHECK(world.elements().topology.copy_count() > 10);
  check_that_it_replays(recorded.recording(), along_faces);
}

TEST_CASE("a recording's file has the cuts, and one of the version before them is refused") {
  const Setup setup = sinking_block();
  const Folder folder;
  write_recording(folder.path / "strokes", displaced(two_strokes(setup), {1, 0, 0}));
  check_that_it_replays(read_recording(folder.path / "strokes"), setup);
  const std::string contents(io::unseal("strokes", io::read_file(folder.path / "strokes"),
                                        {"loberec ", 12, "recording of a world"}));
  CHECK_THROWS_WITH_AS(
      parse_recording("strokes", io::seal({"loberec ", 11, "recording of a world"}, contents)),
      "strokes: is the recording of a world in version 11; this program knows version 12", InputError);
}

TEST_CASE("cuts that do not fit are refused by their name, and the world is as before the frame") {
  const Setup setup = sinking_block();
  const Recording recording = two_strokes(setup);
  const std::size_t at = first_cut(recording);
  World<float> world = world_before(at, recording, setup);
  const RecordedCommand cut = recording.commands[at];
  const Advance good = *part<const Advance>(cut);
  std::vector<std::pair<Advance, const char*>> bad(
      5, {good, "incision: names a point that there is not, or divides an edge at its end"});
  const auto incision = [&](std::size_t i) -> Incision& {
    return bad[i].first.cuts[0].steps.back().incision;
  };
  incision(0).bisections.push_back({0, 1000000, 0.5});
  incision(1).bisections.back().share = 1;
  incision(2).opened.push_back(-4);
  bad[2].second = "incision: opens a face that there is not";
  incision(3).opened.back() = 4 * 1000000;
  bad[3].second = bad[2].second;
  bad[4].first.cuts.push_back(good.cuts[0]);
  bad[4].second = "frame: has cuts of more blades than move in it";
  for (const auto& [advance, message] : bad) {
    CHECK_THROWS_WITH_AS(world.apply(advance), message, InputError);
    CHECK(digest(world) == recording.commands[at - 1].digest);
    validate(world);
  }
  check_the_rest(world, recording, at);
}

TEST_CASE("a frame with cuts of one blade is refused where two move") {
  const Setup setup = sinking_block();
  World<float> world(setup);
  Advance advance{frame};
  for (const double x : {0.0137, 0.0337}) {
    const ToolId blade = world.tools().next_id();
    world.apply(BringScalpel{"blade", {{x, -0.02, 0.06}, {x, 0.07, 0.06}}});
    world.apply(SwitchTool{blade, true});
    world.apply(Lead{blade, {{x, -0.02, 0.03}}});
  }
  World<float> cut(setup);
  cut.restore(world.save());
  const std::vector<BladeCut> cuts = cut.advance(frame).cuts;
  REQUIRE(cuts.size() == 2);
  advance.cuts = {cuts[0]};
  CHECK_THROWS_WITH_AS(world.apply(advance), "frame: has cuts of fewer blades than move in it", InputError);
  advance.cuts = cuts;
  world.apply(advance);
  CHECK(same_bits(world, cut));
}

TEST_CASE("whatever a recording says of its cuts, it is played or refused, and nothing is lost") {
  const Setup setup = sinking_block();
  const Recording recording = two_strokes(setup);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto number = [&](Index below) { return Index(uniform(random) * below) - 1; };
  const auto changes = [&] { return uniform(random) < 0.001; };
  const auto change_row = [&](std::vector<BladeCut::Station>& stations) {
    for (BladeCut::Station& station : stations)
      if (changes()) station = {number(20), number(1000), 0.1 * uniform(random) * station.rest};
  };
  const auto change = [&](BladeCut& cut) {
    change_row(cut.begun);
    if (changes()) cut.ahead.freed.push_back(number(800));
    for (BladeCut::Step& step : cut.steps) {
      for (Incision::Bisection& edge : step.incision.bisections)
        if (changes()) edge = {number(300), number(300), 1.01 * uniform(random)};
      for (Index& code : step.incision.opened)
        if (changes()) code = number(4000);
      for (std::vector<Index>* taken : {&step.taken, &step.taken_before})
        if (changes()) taken->push_back(number(300));
      if (!step.row) continue;
      change_row(step.row->stations);
      if (changes()) step.row.reset();
    }
  };
  int refused = 0, played = 0;
  for (int trial = 0; trial < 60; ++trial) {
    World<float> world(setup);
    bool is_refused = false;
    for (const RecordedCommand& recorded : recording.commands) {
      Command command = std::get<Command>(recorded.command);
      auto* advance = std::get_if<Advance>(&command);
      if (advance && trial % 2 == 1 && is_refused) advance->cuts.clear();  // the blades go on where they are
      if (advance)
        for (BladeCut& cut : advance->cuts) change(cut);
      const std::uint64_t before = digest(world);
      try {
        world.apply(command);
      } catch (const InputError&) {
        is_refused = true;
        REQUIRE(digest(world) == before);
      }
    }
    ++(is_refused ? refused : played);
    validate(world);
    double volume = 0;
    for (Index t = 0; t < world.elements().topology.tet_count(); ++t) volume += world.elements().volume(t);
    CHECK(volume == near(total_volume(setup.mesh), 1e-9));
    CHECK(world.state().u.allFinite());
  }
  CHECK(refused > 5);
  CHECK(played > 5);
}
