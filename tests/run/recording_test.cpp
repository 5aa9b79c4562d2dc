#include "lobe/run/recording.h"

#include <doctest/doctest.h>

#include "fibre_support.h"
#include "lobe/error.h"
#include "near.h"
#include "run/small_scene.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup gesture() {
  Setup setup = hybrid_setup(irregular_box(4));
  setup.gravity = {0, 0, -9.81};
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.cauteries.push_back({"bipolar", 0.006, {{0, {0.02, -0.01, 0.03}}, {0.05, {0.02, 0.05, 0.03}}}});
  return setup;
}

// What an application does to a world while it runs.
template <class Real>
Recording played() {
  World<Real> world(gesture());
  CommandRecorder<Real> recorded(world);
  recorded.advance(0.01);
  recorded.apply(RemoveTets{{3, 4, 5}});
  CHECK(world.elements().topology.alive_count() <= world.elements().topology.tet_count() - 3);
  recorded.apply(SetRegion{{50, 51}, RegionModel::tensor_mass});
  for (int i = 0; i < 4; ++i) recorded.advance(0.01);
  return recorded.recording();
}

Recording changed(Recording recording, const std::function<void(std::vector<RecordedCommand>&)>& change) {
  std::vector<RecordedCommand> entries = recording.commands.all();
  change(entries);
  recording.commands = CommandLog(entries);
  return recording;
}

template <class Real>
ReplayResult replayed_on(int threads, const Recording& recording) {
  World<Real> world(gesture(), threads);
  return replay(recording, world);
}

}  // namespace

TEST_CASE_TEMPLATE("a recording replays bit for bit on one, two and seven threads", Real, float, double) {
  const Recording recording = played<Real>();
  for (int threads : {1, 2, 7}) {
    const ReplayResult replayed = replayed_on<Real>(threads, recording);
    CHECK(replayed.same);
    CHECK(replayed.commands == 7);
    CHECK(replayed.time == near(0.05, 1e-12));
  }
}

TEST_CASE("a recording keeps what was done to an expandable region") {
  Setup setup = gesture();
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (setup.region_of[std::size_t(t)] == RegionModel::tensor_mass && barycentre(setup.mesh, t).z() < 0.01)
      setup.region_of[std::size_t(t)] = RegionModel::precomputed;
  setup.expandable = true;
  World<float> world(setup);
  CommandRecorder<float> recorded(world);
  recorded.apply(Expand{});
  recorded.advance(0.01);
  recorded.apply(Relinearise{0.005});
  recorded.advance(0.01);
  recorded.apply(Condense{});
  for (int i = 0; i < 3; ++i) recorded.advance(0.01);
  World<float> again(setup, 2);
  const ReplayResult replayed = replay(recorded.recording(), again);
  CHECK(replayed.same);
  CHECK(replayed.commands == 8);
  CHECK_FALSE(again.body().regions.is_expanded());
  CHECK(again.body().regions.linearised_about().size() > 0);
}

TEST_CASE("a recording keeps the degrees of selective masses, also in its file") {
  Setup setup = gesture();
  setup.selective_mass = 9;
  World<float> world(setup);
  CommandRecorder<float> recorded(world);
  for (int degree : {1, 3, 9, 1}) {
    recorded.apply(SetMassDegree{degree});
    recorded.advance(0.01);
  }
  const Folder folder;
  write_recording(folder.path / "calls", recorded.recording());
  World<float> again(setup, 2);
  const ReplayResult replayed = replay(read_recording(folder.path / "calls"), again);
  CHECK(replayed.same);
  CHECK(replayed.commands == 8);
  const Recording wrong = changed(recorded.recording(), [](std::vector<RecordedCommand>& entries) {
    std::get<SetMassDegree>(std::get<Command>(entries[0].command)).degree = 4;
  });
  World<float> third(setup);
  CHECK_THROWS_WITH_AS(replay(wrong, third), doctest::Contains("no degree 4"), InputError);
}

TEST_CASE(
    "a recording of a body with fibres replays bit for bit, and is refused where one fibre is another") {
  Setup setup = gesture();
  setup.materials[0] = fibrous();
  setup.mesh.fibres = fibrous_setup(setup.mesh).mesh.fibres;
  World<float> world(setup);
  CommandRecorder<float> recorded(world);
  recorded.advance(0.01);
  recorded.apply(RemoveTets{{3, 4, 5}});
  for (int i = 0; i < 3; ++i) recorded.advance(0.01);
  World<float> again(setup, 2);
  CHECK(replay(recorded.recording(), again).same);
  Index t = setup.mesh.tet_count() - 1;
  while (setup.material_of[std::size_t(t)] != 0) --t;
  setup.mesh.fibres.col(t) = setup.mesh.fibres.col(t).unitOrthogonal();
  World<float> other(setup);
  CHECK_THROWS_WITH_AS(replay(recorded.recording(), other), doctest::Contains("is of another scene"),
                       InputError);
}

TEST_CASE_TEMPLATE("a recording of what relaxes replays bit for bit, and knows its shares", Real, float,
                   double) {
  for (const bool is_smoothed : {false, true}) {
    Setup setup = gesture();
    setup.region_of.assign(setup.region_of.size(), RegionModel::nonlinear);
    for (Elastic& elastic : setup.materials)
      elastic.viscosity = {PronyTerm{0.3, 0.1, 0.004}, PronyTerm{0.2, 0, 0.03}};
    if (is_smoothed) setup = smoothed(setup);
    World<Real> world(setup);
    CommandRecorder<Real> recorded(world);
    recorded.advance(0.01);
    recorded.apply(RemoveTets{{3, 4, 5}});
    recorded.apply(SetRegion{{50, 51}, RegionModel::corotational});
    for (int i = 0; i < 4; ++i) recorded.advance(0.01);
    for (int threads : {1, 2, 7}) {
      World<Real> again(setup, threads);
      CHECK(replay(recorded.recording(), again).same);
    }
    CHECK_THROWS_WITH_AS(world.apply(Command(SetRegion{{50}, RegionModel::tensor_mass})),
                         doctest::Contains("edges have no strain that could relax"), InputError);
    setup.materials[0].viscosity[1].shear = 0.21;
    World<Real> other(setup);
    CHECK_THROWS_WITH_AS(replay(recorded.recording(), other), doctest::Contains("is of another scene"),
                         InputError);
  }
}

TEST_CASE("a replay stops where the bits begin to differ") {
  const Recording recording = changed(played<float>(), [](std::vector<RecordedCommand>& entries) {
    std::get<SetRegion>(std::get<Command>(entries[2].command)).tets = {50};
    std::get<RemoveTets>(std::get<Command>(entries[1].command)).tets.pop_back();
  });
  const ReplayResult replayed = replayed_on<float>(1, recording);
  CHECK_FALSE(replayed.same);
  CHECK(replayed.commands <= 3);
  CHECK(replayed.commands >= 1);
}

TEST_CASE("a recording of another setup or precision is refused") {
  const Recording recording = played<float>();
  CHECK_THROWS_WITH_AS(replayed_on<double>(1, recording), "recording: is in single precision", InputError);
  Setup other = gesture();
  other.damping += 1;
  World<float> world(other);
  CHECK_THROWS_WITH_AS(replay(recording, world), doctest::Contains("is of another scene"), InputError);
}

TEST_CASE("a recording's file gives it back; cut off or damaged anywhere it is refused") {
  const Recording recording = played<double>();
  const Folder folder;
  const auto file = folder.path / "gesture";
  write_recording(file, recording);
  CHECK(replayed_on<double>(1, read_recording(file)).commands == recording.commands.size());
  const std::string whole = bytes_of(file);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    CHECK_THROWS_AS(parse_recording("gesture", whole.substr(0, at)), InputError);
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    CHECK_THROWS_AS(parse_recording("gesture", bytes), InputError);
  }
}
