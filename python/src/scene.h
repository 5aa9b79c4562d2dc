// A scene in Python: with a mesh in memory or in a file, and what it comes to on that.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>

#include "arrays.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"

namespace lobe::python {

// What lobe has chosen or measured for a scene. Another choice might come out differently.
struct Choice {
  std::vector<RegionModel> region_of;
  int selective_mass = 1;
  bool expandable = false;
  std::optional<Proposal> proposal;
  std::vector<std::string> warnings;
};

class PyScene {
 public:
  // Without a mesh it is read from its file. Without a choice one is made, if the scene leaves one to lobe.
  PyScene(Scene scene, std::shared_ptr<const TetMesh> mesh, std::optional<Choice> choice = {})
      : scene_(std::move(scene)), mesh_(std::move(mesh)), choice_(std::move(choice)) {}

  const Scene& scene() const { return scene_; }
  const std::shared_ptr<const TetMesh>& mesh() const { return mesh_; }  // null: it is in a file
  // Made when it is first asked for. Without the GIL: automatic regions may take minutes.
  const Resolved& resolved() const;
  // None if the scene itself says all.
  std::optional<Choice> choice() const;

 private:
  Scene scene_;
  std::shared_ptr<const TetMesh> mesh_;
  std::optional<Choice> choice_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const Resolved> resolved_;
};

py::tuple scene_state(const PyScene& scene);  // for pickle
std::shared_ptr<PyScene> scene_of_state(const py::tuple& state);
py::tuple mesh_state(const TetMesh& mesh);
std::shared_ptr<TetMesh> mesh_of_state(const py::tuple& state);

// A scene and a mesh never change: a copy is the same object.
template <class Class>
void add_copies(Class& python_class) {
  python_class.def("__copy__", [](py::object self) { return self; })
      .def(
          "__deepcopy__", [](py::object self, const py::dict&) { return self; }, py::arg("memo"));
}

void bind_mesh(py::module_& module);
void bind_scene(py::module_& module);
void bind_snapshot(py::module_& module);
void bind_report(py::module_& module);
void bind_checkpoint(py::module_& module);
void bind_tools(py::module_& module);
void bind_world(py::module_& module);
void bind_solve(py::module_& module);

}  // namespace lobe::python
