// Whatever stands in a file of the condensed cache, even under a right length and checksum, the world is
// built, from it or afresh, goes on, and can be cut. The first byte chooses: as it is, or put right.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "fuzz/put_right.h"
#include "fuzz/target.h"
#include "lobe/mesh/generators.h"
#include "lobe/sim/world.h"

using namespace lobe;
namespace fs = std::filesystem;

namespace {

// Three cells in a row: the first held at its end, the first two precomputed.
Setup small_setup(const fs::path& cache) {
  Setup setup;
  setup.mesh = box_mesh({0.03, 0.01, 0.01}, 3, 1, 1);
  setup.materials.emplace_back();
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.region_of.push_back(barycentre(setup.mesh, t).x() < 0.02 ? RegionModel::precomputed
                                                                   : RegionModel::nonlinear);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.005) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -9.81};
  setup.condensed_cache = cache;
  return setup;
}

struct Cache {  // a folder with the one file that the setup asks for
  Cache() {
    World<double> written(small_setup(folder));
    file = fs::directory_iterator(folder)->path();
    key = std::stoull(file.stem().string(), nullptr, 16);
  }
  ~Cache() { fs::remove_all(folder); }

  fs::path folder = fs::temp_directory_path() / ("lobe-fuzz-condensed-" + std::to_string(::getpid())), file;
  std::uint64_t key = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Cache cache;
  if (size == 0) return 0;
  std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] != 'f') fuzz::put_right(bytes, cache.key);
  std::ofstream(cache.file, std::ios::binary) << bytes;
  World<double> world(small_setup(cache.folder));
  world.advance(1e-4);
  world.remove_tets({0});
  world.advance(1e-4);
  if (!world.state().u.allFinite()) __builtin_trap();
  return 0;
}
