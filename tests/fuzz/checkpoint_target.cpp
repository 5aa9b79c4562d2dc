// Whatever stands in a checkpoint or a recording, even under a right length, checksum and fingerprint, reading, restoring
// and going on give a world or an InputError. The first byte chooses: as it is, a checkpoint or a recording put right.
#include <cstring>
#include <string>

#include "fuzz/target.h"
#include "lobe/error.h"
#include "lobe/io/sealed_file.h"
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
  setup.grasps.push_back({"hand", {1}, {{0, Vec3d::Zero()}}, false});
  return setup;
}

// Length, checksum and, in a checkpoint, the fingerprint of this setup (sealed_file.h): what stands between is looked at.
void put_right(std::string& file) {
  constexpr std::size_t length_at = 12, contents_at = 20, checksum_size = 8;
  if (file.size() < contents_at + 2 * checksum_size) return;
  const auto write = [&](std::size_t at, std::uint64_t value) {
    std::memcpy(&file[at], &value, sizeof value);
  };
  const std::size_t end = file.size() - checksum_size;
  write(length_at, end - contents_at);
  write(contents_at, fingerprint(small_setup()));
  write(end, io::digest(std::string_view(file).substr(0, end)));
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
    if (data[0] != 'f') put_right(file);
    data[0] == 'r' ? void(parse_recording("recording", file)) : restore(file);
  } catch (const InputError&) {
  }
  return 0;
}
