#include "benchmarks/reduced_setup.h"

#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <sstream>

#include "benchmarks/machine.h"
#include "benchmarks/timing.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/sim/world.h"

namespace lobe::bench {
namespace {

struct Cost {
  double seconds = 0, bytes = 0;
};

// Of a world of one model: medians of several.
Cost set_up(Setup setup, RegionModel model) {
  std::fill(setup.region_of.begin(), setup.region_of.end(), model);
  std::vector<double> seconds, bytes;
  for (int i = 0; i < 5; ++i) {
    const double before = resident_bytes();
    const Stopwatch watch(true);
    const World<float> world(setup, 1);
    seconds.push_back(watch.seconds());
    bytes.push_back(resident_bytes() - before);
  }
  std::sort(seconds.begin(), seconds.end());
  std::sort(bytes.begin(), bytes.end());
  return {median(seconds), median(bytes)};
}

}  // namespace

void bench_reduced_setup(const Options& options) {
  std::vector<std::filesystem::path> scenes = options.scenes;
  if (scenes.empty())
    scenes.push_back(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / "liver_undeclared.json");
  std::printf("\n%-16s %7s %16s %16s %16s\n", "scene", "tets", "set-up s/million", "bytes per tet",
              "beyond full");
  std::ostringstream out;
  out << "scene,tets,setup_s,setup_s_per_million,bytes_per_tet,bytes_per_tet_beyond_nonlinear\n"
      << std::setprecision(4);
  for (const std::filesystem::path& path : scenes) {
    const Scene scene = read_scene(path);
    std::vector<std::filesystem::path> meshes = options.meshes;
    meshes.insert(meshes.begin(), mesh_path(scene));
    for (const std::filesystem::path& mesh : meshes) {
      const Setup setup = resolve(scene, read_mesh(mesh).mesh, {false}).setup;
      const Cost full = set_up(setup, RegionModel::nonlinear), reduced = set_up(setup, RegionModel::reduced);
      const double tets = setup.mesh.tet_count(), per_million = 1e6 * reduced.seconds / tets,
                   bytes = reduced.bytes / tets, beyond = (reduced.bytes - full.bytes) / tets;
      std::printf("%-16s %7.0f %16.2f %16.0f %16.0f\n", path.stem().string().c_str(), tets, per_million,
                  bytes, beyond);
      out << path.stem().string() << ',' << setup.mesh.tet_count() << ',' << reduced.seconds << ','
          << per_million << ',' << bytes << ',' << beyond << '\n';
    }
  }
  io::write_file(options.output / "reduced_setup.csv", out.str());
}

}  // namespace lobe::bench
