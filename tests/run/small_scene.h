// The scene of this folder's tests: a beam, its held half tensor-mass, its free half non-linear, which is
// grasped at the end, lifted, and burnt through from above to its middle.
#pragma once

#include <nlohmann/json.hpp>

#include "folder.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/run/run.h"
#include "lobe/scene/read_scene.h"

namespace lobe::test {

using Json = nlohmann::ordered_json;

inline TetMesh beam_mesh() {
  TetMesh mesh = box_mesh({0.08, 0.02, 0.02}, 8, 2, 2);
  for (Index t = 0; t < mesh.tet_count(); ++t) mesh.labels[std::size_t(t)] = t % 6;
  return mesh;
}

inline const Vec3d lift{0.002, 0, 0.005};  // the grasp's last offset [m]

inline Json small_scene() {
  return Json::parse(R"({
    "mesh": "beam.vtu",
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
    "volume_penalty": 1e5,
    "regions": [{"model": "tensor-mass", "where": {"box": {"min": [0, 0, 0], "max": [0.03, 1, 1]}}}],
    "boundary": [{"fix": true, "where": {"box": {"min": [0, 0, 0], "max": [0, 1, 1]}}}],
    "gravity": [0, 0, -1],
    "tools": [
      {"type": "grasp", "where": {"box": {"min": [0.08, 0, 0], "max": [0.08, 1, 1]}},
       "path": [[0, 0, 0, 0], [0.2, 0.002, 0, 0.005]]},
      {"type": "cautery", "radius": 0.004, "path": [[0.05, 0.055, -0.01, 0.02], [0.2, 0.055, 0.03, 0.02]]}
    ],
    "time": {"duration": 0.3, "frame": 0.02, "damping": 20},
    "output": {"every": 0.1}
  })");
}

// The grasp pulls so fast from 0.1 s on that no step is stable: the run ends early.
inline Json torn_scene() {
  Json scene = small_scene();
  scene["tools"][0]["path"] = {{0.1, 0, 0, 0}, {0.11, 1000, 0, 0}};
  return scene;
}

// beam.vtu and scene.json in a folder. Returns the scene's path.
inline std::filesystem::path write_scene_files(const Folder& folder, const Json& scene = small_scene()) {
  write_vtu(folder.path / "beam.vtu", beam_mesh());
  return folder.write("scene.json", scene.dump(1));
}

inline RunResult play(const std::filesystem::path& scene_file, const std::filesystem::path& directory,
                      int threads = 1) {
  const Scene scene = read_scene(scene_file);
  return run_scene(scene, resolve(scene, read_mesh(mesh_path(scene)).mesh),
                   {directory, threads, {}, make_ldlt, false, {}});
}

inline Json report_in(const std::filesystem::path& directory) {
  return Json::parse(bytes_of(directory / "report.json"));
}

inline std::string frame_name(std::size_t number) {
  const std::string digits = std::to_string(number);
  return "frame_" + std::string(4 - digits.size(), '0') + digits + ".vtu";
}

}  // namespace lobe::test
