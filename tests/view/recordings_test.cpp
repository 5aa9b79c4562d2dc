// What `--record` has at the end, whatever was applied meanwhile and whatever went wrong.
#include "recordings.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "viewed.h"

using namespace lobe;
using namespace lobe::view;
using namespace lobe::test;

namespace {

// Whether a recording gives the same bits on its scene; with how many commands.
ReplayResult replayed(const Recordings::Written& files) {
  const Scene scene = read_scene(files.scene);
  const Setup setup = resolve(scene, read_mesh(mesh_path(scene)).mesh).setup;
  const Recording recording = read_recording(files.recording);
  World<float> world(as_recorded(recording, setup), 2);
  const ReplayResult result = replay(recording, world);
  CHECK(result.commands == recording.commands.size());
  return result;
}

void pull(Viewed& viewed, double height) {
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.lead(1, 0, 0.03, 0.03, height);
  REQUIRE(
      viewed.comes_to(1, [](const Json& status, const Json&) { return status["time"].get<double>() > 0.1; }));
}

void apply(Viewed& viewed, const char* model) {
  viewed.ask(1, {{"do", "edit"}, {"on", true}});
  viewed.ask(1, {{"do", "paint"}, {"at", {0, 0, 0.06}}, {"radius", 0.02}, {"as", model}});
  viewed.ask(1, {{"do", "apply"}});
  REQUIRE(viewed.comes_to(1, [](const Json& status, const Json&) { return status["mode"] == "live"; }));
}

}  // namespace

TEST_CASE("a recording has what was done before each 'Simulate this': one with its scene for each") {
  Viewed viewed;
  viewed.viewer->opened(1);
  pull(viewed, 0.07);
  apply(viewed, "tensor-mass");
  pull(viewed, 0.066);
  apply(viewed, "nonlinear");
  pull(viewed, 0.062);
  const std::vector<Recordings::Written> written = viewed.viewer->write_recordings();
  REQUIRE(written.size() == 3);
  CHECK(written[0].scene.filename() == "block.json");
  CHECK(written[0].recording == viewed.folder.path / "all.lobe");
  CHECK(written[1].scene == viewed.folder.path / "all.2.json");
  CHECK(written[2].recording == viewed.folder.path / "all.3.lobe");
  for (const Recordings::Written& files : written) {
    const ReplayResult result = replayed(files);
    CHECK(result.same);
    CHECK(result.commands > 12);
    CHECK(result.time > 0.1);
  }
}

TEST_CASE("what cannot be recorded when something else is applied is said, and recorded at the end") {
  Viewed viewed(false, "none", {},
                [](ViewerOptions& options) { options.record = options.folder / "later" / "all.lobe"; });
  viewed.viewer->opened(1);
  pull(viewed, 0.07);
  apply(viewed, "tensor-mass");  // there is no such folder yet
  pull(viewed, 0.07);
  std::filesystem::create_directory(viewed.folder.path / "later");
  const std::vector<Recordings::Written> written = viewed.viewer->write_recordings();
  REQUIRE(written.size() == 2);
  for (const Recordings::Written& files : written) CHECK(replayed(files).same);
}

TEST_CASE("a recording that cannot be written is an error, and the others are written") {
  Viewed viewed;
  viewed.viewer->opened(1);
  std::filesystem::create_directories(viewed.folder.path / "all.lobe" / "in the way");
  apply(viewed, "tensor-mass");
  pull(viewed, 0.07);
  CHECK_THROWS_AS(viewed.viewer->write_recordings(), InputError);
  CHECK(replayed({viewed.folder.path / "all.2.json", viewed.folder.path / "all.2.lobe"}).same);
}

TEST_CASE("without --record nothing is written") {
  Viewed viewed(false, "none", {}, [](ViewerOptions& options) { options.record.clear(); });
  viewed.viewer->opened(1);
  apply(viewed, "tensor-mass");
  CHECK(viewed.viewer->write_recordings().empty());
  CHECK(viewed.folder.file_count() == 2);  // scene and mesh
}
