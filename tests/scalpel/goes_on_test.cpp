// After a replay blades go on where they are, with the bits of the world that was recorded. A replay takes
// from the recording what a blade knows of the body and what is done ahead of it.
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

#include "lobe/error.h"
#include "lobe/file/fields.h"
#include "lobe/sim/left_out_fields.h"
#include "lobe/sim/validate.h"
#include "recorded_strokes.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

struct Hand {
  Vec3d tip, heel, down;  // of its blade, and how it goes in a frame
};
// In each frame the blades with these numbers go down.
using Downs = std::vector<std::vector<std::size_t>>;

Downs times(int count, const std::vector<std::size_t>& together) {
  return Downs(std::size_t(count), together);
}

Downs operator+(Downs a, const Downs& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const std::vector<Hand> across{{{0.0222, -0.0137, 0.06}, {0.0252, 0.0663, 0.06}, {0, -0.0005, -0.006}},
                               {{-0.0163, 0.0283, 0.06}, {0.0637, 0.0243, 0.062}, {0, -0.0005, -0.006}}};

template <class Real = float>
Recording recording_of(const Setup& setup, const std::vector<Hand>& hands, const Downs& downs,
                       double duration = frame, bool along_faces = false) {
  World<Real> world(setup);
  CommandRecorder<Real> recorded(world);
  std::vector<ToolId> blades;
  std::vector<Vec3d> tips;
  for (const Hand& hand : hands) {
    blades.push_back(world.tools().next_id());
    tips.push_back(hand.tip);
    recorded.apply(BringScalpel{"blade", {hand.tip, hand.heel}, 0.1, along_faces});
    recorded.apply(SwitchTool{blades.back(), true});
  }
  for (const std::vector<std::size_t>& together : downs) {
    for (const std::size_t i : together) recorded.apply(Lead{blades[i], {tips[i] += hands[i].down}});
    REQUIRE(recorded.advance(duration).ok);
  }
  REQUIRE(world.elements().topology.copy_count() > 10);
  return recorded.recording();
}

const Command& command_of(const RecordedCommand& recorded) { return std::get<Command>(recorded.command); }

template <class Real>
std::uint64_t digest_of_blades(const World<Real>& world) {
  return io::digest_of_fields(world.save().blades);
}

// What blades cut in it. A frame with cuts repeats these.
template <class Real>
std::vector<BladeCut> apply(World<Real>& world, const Command& command) {
  const auto* frame = std::get_if<Advance>(&command);
  if (frame && frame->cuts.empty()) return world.advance(frame->duration).cuts;
  world.apply(command);
  return frame ? frame->cuts : std::vector<BladeCut>{};
}

// The first `replayed` commands are played with their cuts, the others without. `simply` decides all cuts.
template <class Real = float>
void check_that_it_goes_on(const Recording& recording, const Setup& setup, std::size_t replayed) {
  World<Real> world(setup), simply(setup);
  const std::vector<RecordedCommand> entries = recording.commands.all(),
                                     live = without_cuts(recording).commands.all();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto cuts = apply(world, command_of((i < replayed ? entries : live)[i]));
    REQUIRE(cuts == apply(simply, command_of(live[i])));
    REQUIRE(digest(world) == entries[i].digest);
    REQUIRE(digest_of_blades(world) == digest_of_blades(simply));
  }
  CHECK(io::digest_of_fields(world.save()) == io::digest_of_fields(simply.save()));
  validate(world);
}

template <class Real = float>
void check_that_it_goes_on(const Recording& recording, const Setup& setup) {
  const std::size_t count = recording.commands.size();
  for (const std::size_t replayed : {count / 3, count / 2, 2 * count / 3, count - 2, count})
    check_that_it_goes_on<Real>(recording, setup, replayed);
}

std::vector<BladeCut::Step> steps_of(const Recording& recording) {
  std::vector<BladeCut::Step> steps;
  for (const RecordedCommand& entry : recording.commands)
    if (const Advance* frame = part<const Advance>(entry))
      for (const BladeCut& cut : frame->cuts) steps.insert(steps.end(), cut.steps.begin(), cut.steps.end());
  return steps;
}

Recording changed(const Recording& recording, const std::function<void(BladeCut&)>& change) {
  return with_changed_cuts(recording, [&](Advance& frame) {
    for (BladeCut& cut : frame.cuts) change(cut);
  });
}

Recording without_ahead(const Recording& recording) {
  return changed(recording, [](BladeCut& cut) { cut.ahead = {}; });
}

template <class Real = float>
bool replays(const Recording& recording, const Setup& setup) {
  World<Real> world(setup);
  const bool same = replay(recording, world).same;
  validate(world);
  return same;
}

}  // namespace

TEST_CASE("a blade goes on after a replay as if there had been none, in the middle of its stroke") {
  for (const RegionModel model :
       {RegionModel::nonlinear, RegionModel::tensor_mass, RegionModel::precomputed}) {
    const Setup setup = sinking_block(model);
    check_that_it_goes_on(recording_of(setup, {across[0]}, times(8, {0})), setup);
  }
}

TEST_CASE("two blades that cross go on after a replay") {
  const Setup setup = sinking_block();
  check_that_it_goes_on(recording_of(setup, across, times(8, {0, 1})), setup);
}

TEST_CASE("a blade along faces goes on after a replay") {
  const Setup setup = sinking_block();
  check_that_it_goes_on(recording_of(setup, across, times(8, {0, 1}), frame, true), setup);
}

TEST_CASE("a blade goes on after a replay in which another has divided what it left behind") {
  const Setup setup = sinking_block();
  const Recording recording =
      recording_of(setup, across, times(5, {0}) + times(8, {1}) + times(1, {}) + times(3, {0}));
  std::size_t caught_up = 0, taken = 0;
  for (const BladeCut::Step& step : steps_of(recording)) {
    caught_up += step.caught_up.bisections.size();
    taken += step.taken.size() + step.taken_before.size();
  }
  REQUIRE(caught_up > 0);
  REQUIRE(taken > 0);
  for (std::size_t replayed = 8; replayed <= recording.commands.size(); replayed += 3)
    check_that_it_goes_on(recording, setup, replayed);
}

TEST_CASE("what a blade knows of the body is replayed, wherever the blade is") {
  const Setup setup = sinking_block();
  const Recording recording = recording_of(setup, across, times(5, {0, 1}));
  World<float> world(setup), far(setup);
  REQUIRE(replay(recording, world).same);
  CHECK(replay(displaced(recording, {1, 0, 0}), far).same);
  const std::vector<Blades::Stroke> known = world.save().blades.strokes, same = far.save().blades.strokes;
  REQUIRE(known.size() == 2);
  REQUIRE(same.size() == 2);
  int inside = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    CHECK(same[s].bit == known[s].bit);
    CHECK(same[s].begun == known[s].begun);
    CHECK(same[s].points_seen == known[s].points_seen);
    REQUIRE(same[s].rows.size() == known[s].rows.size());
    for (std::size_t r = 0; r < known[s].rows.size(); ++r)
      for (std::size_t i = 0; i < known[s].rows[r].size(); ++i) {
        const Blades::BladePoint &at = known[s].rows[r][i], &same_at = same[s].rows[r][i];
        CHECK(same_at.grain == at.grain);
        CHECK(same_at.rest == at.rest);
        inside += at.grain >= 0;
      }
  }
  CHECK(inside > 20);
  CHECK(far.save().blades.on == world.save().blades.on);
  // The bits of the replay do not depend on what the blade knows, but those afterwards do.
  using Step = BladeCut::Step;
  const std::vector<void (*)(Step&)> forgotten{
      [](Step& step) { step.taken.clear(); },
      [](Step& step) { step.row.reset(); },
      [](Step& step) {
        if (step.row) step.row->stations.clear();
      },
      [](Step& step) {
        if (step.row) step.row->is_new = !step.row->is_new;
      },
  };
  for (const auto& forget : forgotten) {
    World<float> blind(setup);
    const Recording unknown =
        changed(recording, [&](BladeCut& cut) { std::for_each(cut.steps.begin(), cut.steps.end(), forget); });
    CHECK(replay(unknown, blind).same);
    CHECK(digest_of_blades(blind) != digest_of_blades(world));
  }
}

TEST_CASE("an expandable region is expanded in a replay where it was in the recorded run") {
  const Setup setup = sinking_block(RegionModel::precomputed);
  const Recording recording = recording_of(setup, across, times(8, {0, 1}));
  int expanded = 0;
  changed(recording, [&](BladeCut& cut) { expanded += cut.ahead.expands; });
  CHECK(expanded == 1);
  for (const Vec3d& by : {Vec3d(0, 0, 0), Vec3d(1, 0, 0)}) {
    CHECK(replays(displaced(recording, by), setup));
    CHECK_FALSE(replays(without_ahead(displaced(recording, by)), setup));
  }
}

TEST_CASE("reduced tetrahedra become non-linear in a replay where they did in the recorded run") {
  Setup setup = setup_of(box_mesh({0.16, 0.04, 0.04}, 16, 4, 4), RegionModel::reduced);
  setup.lattice_cell = 0.02;
  setup.volume_penalty = 1e5;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.005) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -1};
  setup.damping = 10;
  const std::vector<Hand> hands{{{0.083, -0.01, 0.055}, {0.083, 0.05, 0.055}, {0, 0, -0.005}}};
  const Recording recording = recording_of<double>(setup, hands, times(10, {0}), 0.01);
  std::size_t freed = 0;
  changed(recording, [&](BladeCut& cut) { freed += cut.ahead.freed.size(); });
  CHECK(freed > 100);
  for (const Vec3d& by : {Vec3d(0, 0, 0), Vec3d(1, 0, 0)}) {
    CHECK(replays<double>(displaced(recording, by), setup));
    CHECK_FALSE(replays<double>(without_ahead(displaced(recording, by)), setup));
  }
  check_that_it_goes_on<double>(recording, setup);
}

TEST_CASE("what a blade is said to know is refused by its name if there is no such thing in the body") {
  const Setup setup = sinking_block();
  const Recording recording = recording_of(setup, across, times(8, {0, 1}));
  struct Bad {
    const char* message;
    std::function<bool(BladeCut&)> damage;  // false: there is nothing to damage in this cut
  };
  const auto station = [](auto&& damage) {
    return [damage](BladeCut& cut) {
      std::optional<BladeCut::Row>& row = cut.steps.back().row;
      if (!row || row->stations.empty()) return false;
      damage(row->stations.back());
      return true;
    };
  };
  const auto step = [](auto&& damage) {
    return [damage](BladeCut& cut) {
      BladeCut::Step& last = cut.steps.back();
      if (last.incision.bisections.empty()) return false;
      damage(last);
      return true;
    };
  };
  const char *in_no_grain = "frame: has a blade's edge in grains that there are not",
             *no_point = "incision: takes a point that there is not";
  const std::vector<Bad> all{
      {in_no_grain, station([](BladeCut::Station& s) { s.grain = 1000000; })},
      {in_no_grain, station([](BladeCut::Station& s) { s.grain = -1; })},
      {in_no_grain, station([](BladeCut::Station& s) { s.at = -1; })},
      {in_no_grain, station([](BladeCut::Station& s) { s.at = 64; })},
      {in_no_grain, station([](BladeCut::Station& s) { s.rest.y() = std::nan(""); })},
      {no_point, step([](BladeCut::Step& s) { s.taken.push_back(1000000); })},
      {no_point, step([](BladeCut::Step& s) { s.taken.push_back(-1); })},
      {no_point, step([](BladeCut::Step& s) {
         s.taken_before.push_back(1000000);
         s.caught_up.stroke = s.incision.stroke;
       })},
      {"incision: is of another stroke", step([](BladeCut::Step& s) { ++s.incision.stroke; })},
      {"incision: is of another stroke", step([](BladeCut::Step& s) { s.incision.stroke = -1; })},
  };
  for (const Bad& bad : all) {
    CAPTURE(bad.message);
    World<float> world(setup);
    bool is_damaged = false;
    for (const RecordedCommand& recorded : recording.commands) {
      Command command = command_of(recorded);
      if (auto* advance = std::get_if<Advance>(&command); advance && !advance->cuts.empty() && !is_damaged) {
        const std::uint64_t before = digest(world), blades_before = digest_of_blades(world);
        is_damaged = bad.damage(advance->cuts.back());
        if (is_damaged) {
          CHECK_THROWS_WITH_AS(world.apply(command), bad.message, InputError);
          CHECK(digest(world) == before);
          CHECK(digest_of_blades(world) == blades_before);
          validate(world);
          command = command_of(recorded);
        }
      }
      world.apply(command);
      REQUIRE(digest(world) == recorded.digest);
    }
    CHECK(is_damaged);
  }
}

TEST_CASE("what is said to be done ahead of a blade is refused by its name if it cannot be done") {
  const Setup setup = sinking_block();
  const Recording recording = recording_of(setup, across, times(8, {0, 1}));
  World<float> world(setup);
  const std::vector<RecordedCommand> entries = recording.commands.all();
  std::size_t at = 0;
  while (part<const Advance>(entries[at]) == nullptr) world.apply(command_of(entries[at++]));
  const std::uint64_t before = digest(world);
  Advance freed = *part<const Advance>(entries[at]), expanded = freed;
  REQUIRE(freed.cuts.size() == 2);
  freed.cuts[1].ahead.freed = {1000000};
  CHECK_THROWS_WITH_AS(
      world.apply(freed),
      ("tetrahedron 1000000: there are " + std::to_string(setup.mesh.tet_count()) + ", numbered from 0")
          .c_str(),
      InputError);
  CHECK(digest(world) == before);
  expanded.cuts[1].ahead.expands = true;
  CHECK_THROWS_WITH_AS(world.apply(expanded), "region: the setup does not say that it may be expanded",
                       InputError);
  CHECK(digest(world) == before);
  for (; at < entries.size(); ++at) {
    world.apply(command_of(entries[at]));
    REQUIRE(digest(world) == entries[at].digest);
  }
}
