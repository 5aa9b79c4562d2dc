// Whatever stands in a checkpoint or a recording, even under a right length, checksum and fingerprint,
// reading, restoring and going on give a world or an InputError. The first byte chooses: as it is, a
// checkpoint or a recording put right.
#include "fuzz/checkpoint_setup.h"
#include "fuzz/put_right.h"
#include "fuzz/target.h"
#include "lobe/error.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"

using namespace lobe;

namespace {

void restore(const std::string& bytes) {
  World<float> world(fuzz::small_setup());
  world.restore(parse_checkpoint<float>("state", bytes));
  world.advance(1e-7);
  if (!world.state().u.allFinite()) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string file(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] != 'f') fuzz::put_right(file, fingerprint(fuzz::small_setup()));
    data[0] == 'r' ? void(parse_recording("recording", file)) : restore(file);
  } catch (const InputError&) {
  }
  return 0;
}
