#include "recordings.h"

#include <exception>
#include <utility>

#include "lobe/file/atomic_file.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"

namespace lobe::view {

void Recordings::write(const Part& part) {
  const std::filesystem::path folder = file_.parent_path();
  std::filesystem::path scene = part.scene.file, recording = file_;
  if (part.number > 1) {
    const std::string stem = file_.stem().string() + "." + std::to_string(part.number);
    Scene painted = part.scene;
    save_scene_mesh(part.mesh, folder, stem, painted);
    scene = folder / (stem + ".json");
    recording = folder / (stem + file_.extension().string());
    io::write_file(scene, to_json(painted));
  }
  part.live->write_recording(recording);
  written_.push_back({scene, recording});
}

void Recordings::ended(std::shared_ptr<Live> live, const Scene& scene, const TetMesh& mesh) {
  ++sessions_;
  if (file_.empty()) return;
  Part part{sessions_, std::move(live), scene, mesh};
  try {
    write(part);
  } catch (...) {
    unwritten_.push_back(std::move(part));
    throw;
  }
}

void Recordings::end(std::shared_ptr<Live> live, const Scene& scene, const TetMesh& mesh) {
  std::exception_ptr failure;
  const auto attempt = [&](const auto& work) {
    try {
      work();
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  };
  for (const Part& part : std::exchange(unwritten_, {})) attempt([&] { write(part); });
  attempt([&] { ended(std::move(live), scene, mesh); });
  if (failure) std::rethrow_exception(failure);
}

}  // namespace lobe::view
