// Whatever stands in a checkpoint or a recording, even under a right length, checksum and fingerprint,
// reading, restoring, playing and going on give a world or an InputError. What is refused changes nothing.
// The first byte chooses: as it is, a checkpoint or a recording put right.
#include <algorithm>

#include "fuzz/checkpoint_setup.h"
#include "fuzz/put_right.h"
#include "fuzz/target.h"
#include "lobe/error.h"
#include "lobe/file/fields.h"
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

// The first commands, in short frames.
void play(const std::string& bytes) {
  constexpr std::size_t most = 30;
  const Recording recording = parse_recording("recording", bytes);
  World<float> world(fuzz::small_setup());
  std::size_t played = 0;
  for (RecordedCommand entry : recording.commands) {
    if (played++ == most) return;
    auto* command = std::get_if<Command>(&entry.command);
    if (!command) continue;
    if (auto* advance = std::get_if<Advance>(command)) advance->duration = 1e-6;
    const std::uint64_t before = digest(world), blades_before = io::digest_of_fields(world.save().blades);
    try {
      world.apply(*command);
    } catch (const InputError&) {
      if (digest(world) != before || io::digest_of_fields(world.save().blades) != blades_before)
        __builtin_trap();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string file(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] != 'f') fuzz::put_right(file, fingerprint(fuzz::small_setup()));
    data[0] == 'r' ? play(file) : restore(file);
  } catch (const InputError&) {
  }
  return 0;
}
