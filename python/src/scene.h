// A scene in Python: with a mesh in memory or in a file, and what it comes to on that.
#pragma once

#include <memory>
#include <optional>

#include "arrays.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"

namespace lobe::python {

class PyScene {
 public:
  PyScene(Scene scene, std::shared_ptr<const TetMesh> mesh, std::optional<std::vector<RegionModel>> regions)
      : scene_(std::move(scene)), mesh_(std::move(mesh)), regions_(std::move(regions)) {}

  const Scene& scene() const { return scene_; }
  // Made when it is first asked for. Without the GIL: automatic regions may take minutes.
  const Resolved& resolved() const;

 private:
  Scene scene_;
  std::shared_ptr<const TetMesh> mesh_;  // none: read from its file
  std::optional<std::vector<RegionModel>> regions_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const Resolved> resolved_;
};

RegionModel region_model(const std::string& name, const std::string& place);

void bind_mesh(py::module_& module);
void bind_scene(py::module_& module);
void bind_snapshot(py::module_& module);
void bind_world(py::module_& module);
void bind_solve(py::module_& module);

}  // namespace lobe::python
