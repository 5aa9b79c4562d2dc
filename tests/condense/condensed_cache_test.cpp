#include "lobe/condense/condensed_cache.h"

#include <doctest/doctest.h>

#include <fstream>

#include "condense/half_linear.h"
#include "folder.h"
#include "lobe/sim/rebuild.h"
#include "lobe/sim/world.h"

using namespace lobe;
using namespace lobe::test;

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> files(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path());
  return found;
}

Index notices(World<double>& world) {
  Index count = 0;
  for (const Condition& c : world.advance(1e-4).conditions) count += c.kind == Condition::Kind::cache;
  return count;
}

Mat3X<double> displaced_forces(World<double>& world) {
  world.set_state(random_state(world, 1e-3));
  return world.forces();
}

}  // namespace

TEST_CASE(
    "a condensed region from disk is the one that was kept, and cuts go on from it with the same bits") {
  const Folder folder;
  Setup setup = half_linear(RegionModel::precomputed);
  load(setup);
  World<double> without(setup);
  setup.condensed_cache = folder.path / "new/cache";
  World<double> first(setup);
  REQUIRE(files(setup.condensed_cache).size() == 1);
  const auto written = fs::last_write_time(files(setup.condensed_cache)[0]);
  World<double> second(setup);
  CHECK(files(setup.condensed_cache).size() == 1);
  CHECK(fs::last_write_time(files(setup.condensed_cache)[0]) == written);
  CHECK(displaced_forces(second) == displaced_forces(without));
  CHECK(second.state().u == without.state().u);
  for (World<double>* world : {&without, &second}) world->remove_tets({3, 4, 20, 21, 22});
  CHECK(displaced_forces(second) == displaced_forces(without));
  CHECK(compare_with_rebuilt(second).largest() < 1e-9);
}

TEST_CASE("condensing tells how far it is and what it took, and from the disk it takes nothing") {
  const Folder folder;
  Setup setup = half_linear(RegionModel::precomputed);
  setup.condensed_cache = folder.path;
  std::vector<double> fractions;
  const auto note = [&](double fraction) { fractions.push_back(fraction); };
  World<double> first(setup, 1, note);
  CHECK(fractions == std::vector<double>{1.0 / 3, 2.0 / 3, 1});
  for (double seconds : first.body().regions.condensing().seconds()) CHECK(seconds > 0);
  World<double> second(setup, 1, note);
  CHECK(fractions.size() == 3);
  for (double seconds : second.body().regions.condensing().seconds()) CHECK(seconds == 0);
}

TEST_CASE("whatever changes a condensed region finds none on disk") {
  const Folder folder;
  Setup setup = half_linear(RegionModel::precomputed, 3);
  setup.condensed_cache = folder.path;
  std::vector<Setup> others(6, setup);
  others[1].mesh.points(0, 5) += 1e-9;
  others[2].materials[0].mu *= 1 + 1e-12;
  others[3].gravity = {0, 0, -1};
  others[4].prescribed[0].axes[1] = !others[4].prescribed[0].axes[1];
  others[5].region_of[0] = RegionModel::nonlinear;
  for (std::size_t i = 0; i < others.size(); ++i) {
    CAPTURE(i);
    World<double> world(others[i]);
    CHECK(files(folder.path).size() == i + 1);
    others[i].condensed_cache.clear();
    World<double> afresh(others[i]);
    CHECK(displaced_forces(world) == displaced_forces(afresh));
  }
}

TEST_CASE("a file under the name of another one is replaced with a notice") {
  const Folder folder;
  Setup light = half_linear(RegionModel::precomputed, 3), heavy = light;
  light.condensed_cache = heavy.condensed_cache = folder.path;
  heavy.gravity = {0, 0, -9.81};
  World<double> first(light);
  const fs::path own = files(folder.path)[0];
  World<double> expected(heavy);
  for (const fs::path& file : files(folder.path))
    if (file != own) fs::copy_file(own, file, fs::copy_options::overwrite_existing);
  World<double> afresh(heavy);
  CHECK(notices(afresh) == 1);
  CHECK(displaced_forces(afresh) == displaced_forces(expected));
}

TEST_CASE("a damaged file is replaced with a notice, and a folder that cannot be written to is left alone") {
  const Folder folder;
  Setup setup = half_linear(RegionModel::precomputed, 3);
  World<double> without(setup);
  setup.condensed_cache = folder.path;
  World<double> first(setup);
  CHECK(notices(first) == 0);
  const fs::path file = files(folder.path)[0];
  const auto whole = fs::file_size(file);
  {
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
        .seekp(std::streamoff(whole / 2))
        .put('x');
  }
  World<double> damaged(setup);
  CHECK(notices(damaged) == 1);
  CHECK(displaced_forces(damaged) == displaced_forces(without));
  World<double> replaced(setup);
  CHECK(notices(replaced) == 0);
  fs::resize_file(file, whole - 9);
  World<double> cut_off(setup);
  CHECK(notices(cut_off) == 1);
  CHECK(fs::file_size(file) == whole);
  setup.condensed_cache = file;
  World<double> no_folder(setup);
  CHECK(notices(no_folder) == 1);
  CHECK(displaced_forces(no_folder) == displaced_forces(without));
}
