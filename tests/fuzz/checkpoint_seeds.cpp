// Writes the inputs from which checkpoints and recordings are fuzzed: `fuzz_checkpoint_seeds FOLDER`. They
// are made and not committed, so that they have the version that the reader takes.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "fuzz/checkpoint_setup.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"

using namespace lobe;
namespace fs = std::filesystem;

namespace {

constexpr double frame = 1e-5;  // [s]

class Seeds {
 public:
  explicit Seeds(const fs::path& folder) : folder_(folder) { fs::create_directories(folder); }

  // What checkpoint_target.cpp does with it is said by the first byte.
  void add(const std::string& name, char first, const World<float>& world) const {
    write_checkpoint(scratch(), world.save());
    write(name, first);
  }
  void add(const std::string& name, const Recording& recording) const {
    write_recording(scratch(), recording);
    write(name, 'r');
  }

 private:
  fs::path scratch() const { return folder_ / "scratch"; }
  void write(const std::string& name, char first) const {
    std::ifstream in(scratch(), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    std::ofstream(folder_ / name, std::ios::binary) << first << bytes;
    in.close();
    fs::remove(scratch());
  }

  fs::path folder_;
};

// Through the middle of the bar, aslant, in two frames; the second stroke is under way at the end.
template <class Played>  // World or CommandRecorder
void cut(Played& played, const World<float>& world) {
  for (const double x : {0.011, 0.006}) {
    const Vec3d tip(x, -0.01, 0.02), heel(x + 0.001, 0.02, 0.02);
    const ToolId blade = world.tools().next_id();
    played.apply(BringScalpel{"blade", {tip, heel}});
    played.apply(SwitchTool{blade, true});
    for (const double down : {0.012, x > 0.01 ? 0.03 : 0.015}) {
      played.apply(Lead{blade, {tip - Vec3d(0, 0, down)}});
      played.advance(frame);
    }
    if (x > 0.01) played.apply(LetGo{blade});
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "fuzz_checkpoint_seeds FOLDER\n");
    return 2;
  }
  const Seeds seeds(argv[1]);
  const Setup setup = fuzz::small_setup();

  const World<float> plain(setup);
  seeds.add("plain", 'c', plain);
  seeds.add("unsealed", 'f', plain);

  World<float> held(setup);
  held.advance(frame);
  seeds.add("held", 'c', held);

  World<float> edited(setup);
  edited.apply(SetRegion{{0, 1, 2}, RegionModel::tensor_mass});
  edited.remove_tets({5});
  seeds.add("edited", 'c', edited);

  World<float> incised(setup);
  cut(incised, incised);
  if (!incised.grains() || incised.elements().topology.tet_copy_count() == 0) return 1;
  seeds.add("incised", 'c', incised);

  World<float> recorded(setup);
  CommandRecorder<float> recorder(recorded);
  recorder.apply(RemoveTets{{3}});
  cut(recorder, recorded);
  seeds.add("recording", recorder.recording());
  return 0;
}
