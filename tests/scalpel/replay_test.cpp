// A replay plays blades again as tools, which cut the same.
#include <doctest/doctest.h>

#include "folder.h"
#include "lobe/run/recording.h"
#include "lobe/sim/validate.h"
#include "sinking_block.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Two blades in hands come down through the block, one after the other, so that their cuts cross.
Recording two_strokes(const Setup& setup, bool along_faces = false) {
  World<float> world(setup);
  CommandRecorder<float> recorded(world);
  for (const Vec3d& along : {Vec3d(0.003, 0.08, 0), Vec3d(0.08, -0.004, 0.002)}) {
    const Vec3d tip = Vec3d(0.0237, 0.0263, 0.06) - along / 2;
    const ToolId blade = world.tools().next_id();
    recorded.apply(BringScalpel{"blade", {tip, tip + along}, 0.1, along_faces});
    recorded.apply(SwitchTool{blade, true});
    for (int i = 1; i <= 8; ++i) {
      recorded.apply(Lead{blade, {tip - Vec3d(0, 0.0005 * i, 0.006 * i)}});
      REQUIRE(recorded.advance(frame).ok);
    }
    recorded.apply(LetGo{blade});
  }
  REQUIRE(recorded.advance(frame).ok);
  REQUIRE(world.elements().topology.copy_count() > 10);
  return recorded.recording();
}

void check_that_it_replays(const Recording& recording, const Setup& setup) {
  for (const int threads : {1, 2}) {
    World<float> world(setup, threads);
    const ReplayResult replayed = replay(recording, world);
    CHECK(replayed.same);
    CHECK(replayed.commands == recording.commands.size());
    validate(world);
  }
}

}  // namespace

TEST_CASE("a replay cuts what was cut, in a region of any model") {
  for (const RegionModel model :
       {RegionModel::nonlinear, RegionModel::tensor_mass, RegionModel::precomputed, RegionModel::reduced}) {
    const Setup setup = sinking_block(model);
    check_that_it_replays(two_strokes(setup), setup);
  }
}

TEST_CASE("a replay opens the faces that a blade along faces has opened") {
  const Setup setup = sinking_block();
  check_that_it_replays(two_strokes(setup, true), setup);
}

TEST_CASE("a replay of a recording from a file cuts what was cut") {
  const Setup setup = sinking_block();
  const Folder folder;
  write_recording(folder.path / "strokes", two_strokes(setup));
  check_that_it_replays(read_recording(folder.path / "strokes"), setup);
}
