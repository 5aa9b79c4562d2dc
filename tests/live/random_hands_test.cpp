// Whatever hands do, whenever they do it and whoever looks on: a replay of the record gives the same bits.
#include "benchmarks/random_session.h"
#include "live/hands_support.h"
#include "lobe/sim/validate.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class Entry>
long count(const Recording& recording) {
  long entries = 0;
  for (const RecordedCommand& recorded : recording.commands) {
    if constexpr (std::is_same_v<Entry, GoBack>)
      entries += std::holds_alternative<GoBack>(recorded.command);
    else if (const auto* command = std::get_if<Command>(&recorded.command))
      entries += std::holds_alternative<Entry>(*command);
  }
  return entries;
}

}  // namespace

TEST_CASE("what random hands of several threads did is replayed bit for bit, on one thread and on two") {
  const Setup setup = block();
  bench::RandomSessionOptions options;
  options.hands = {.low = Vec3d::Zero(), .high = Vec3d::Constant(0.05), .removable = {}};
  options.hands.removable = {100, 200, 300, 301, 302, 400, 401};
  options.seconds = 15;
  // When a command is obeyed depends on the clock: sessions are played until both rare things were done.
  long burns = 0, returns = 0;
  for (unsigned seed = 1; seed <= 2 || (seed <= 8 && (burns == 0 || returns == 0)); ++seed) {
    options.threads = 1 + int(seed + 1) % 2;
    options.seed = seed;
    const bench::RandomSession played = bench::play_at_random(setup, options);
    CHECK(played.faults == 0);
    CHECK(count<Advance>(played.recording) > 100);
    CHECK(count<TakeHold>(played.recording) > 3);
    CHECK(count<Lead>(played.recording) > 30);
    CHECK(count<LetGo>(played.recording) > 3);
    burns += count<SwitchTool>(played.recording);
    returns += count<GoBack>(played.recording);
    for (int again : {1, 2}) {
      World<float> world(setup, again);
      const ReplayResult replayed = replay(played.recording, world);
      CHECK(replayed.commands == played.recording.commands.size());
      CHECK(replayed.same);
      CHECK(digest(world) == played.last);
      CHECK(world.elements().topology.alive_count() == played.alive);
    }
  }
  CHECK(burns > 0);
  CHECK(returns > 0);
}

TEST_CASE("what random hands with scalpels did is replayed bit for bit, and no tissue is lost") {
  const Setup setup = block();
  bench::RandomSessionOptions options;
  options.hands = {.low = Vec3d::Zero(), .high = Vec3d::Constant(0.05), .removable = {}};
  options.hands.brings_scalpels = true;
  options.seconds = 4;
  long incisions = 0;
  for (unsigned seed = 1; seed <= 2 || (seed <= 8 && incisions == 0); ++seed) {
    options.seed = seed;
    const bench::RandomSession played = bench::play_at_random(setup, options);
    CHECK(played.faults == 0);
    for (int again : {1, 2}) {
      World<float> world(setup, again);
      const ReplayResult replayed = replay(played.recording, world);
      CHECK(replayed.commands == played.recording.commands.size());
      CHECK(replayed.same);
      CHECK(digest(world) == played.last);
      validate(world);
      double volume = 0;
      const Elements& elements = world.elements();
      for (Index t = 0; t < elements.topology.tet_count(); ++t)
        if (elements.topology.alive(t)) volume += elements.volume(t);
      CHECK(volume == near(total_volume(setup.mesh), 1e-12));
      incisions += elements.topology.tet_count() > setup.mesh.tet_count();
    }
  }
  CHECK(incisions > 0);
}
