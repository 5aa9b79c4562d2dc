// Whatever stands in a checkpoint or a recording, even under a right length, checksum and fingerprint,
// reading, restoring and going on give a world or an InputError. The first byte chooses: as it is, a
// checkpoint or a recording put right.
#include "fuzz/put_right.h"
#include "fuzz/target.h"
#include "lobe/error.h"
#include "lobe/mesh/generators.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"

using namespace lobe;

namespace {

Setup small_setup() {
  Setup setup;
  setup.mesh = box_mesh({0.02, 0.01, 0.01}, 2, 1, 1);
  setup.materials.emplace_back();
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.prescribed.push_back({0, Vec3d::Zero()});
  setup.guard_below = 0.2;
  setup.grasps.push_back({"hand", {1}, {{0, Vec3d::Zero()}}, false});
  return setup;
}

void restore(const std::string& bytes) {
  World<float> world(small_setup());
  world.restore(parse_checkpoint<float>("state", bytes));
  world.advance(1e-7);
  if (!world.state().u.allFinite()) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string file(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] != 'f') fuzz::put_right(file, fingerprint(small_setup()));
    data[0] == 'r' ? void(parse_recording("recording", file)) : restore(file);
  } catch (const InputError&) {
  }
  return 0;
}
