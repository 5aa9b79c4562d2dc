#include "scene.h"

#include "lobe/io/mesh_io.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/scene_mesh.h"

namespace lobe::python {
namespace {

void take_choice(const Choice& choice, Resolved& resolved) {
  resolved.setup.region_of = choice.region_of;
  resolved.setup.selective_mass = choice.selective_mass;
  resolved.setup.expandable = choice.expandable;
  resolved.proposal = choice.proposal;
  resolved.warnings = choice.warnings;
}

}  // namespace

const Resolved& PyScene::resolved() const {
  const py::gil_scoped_release others_run;
  const std::lock_guard lock(mutex_);
  if (!resolved_) {
    Scene scene = scene_;
    MeshFile file;
    if (!mesh_) bind_groups(file = read_scene_mesh(scene_), scene);
    Resolved resolved = resolve(scene, mesh_ ? *mesh_ : std::move(file.mesh), {!choice_});
    if (choice_) take_choice(*choice_, resolved);
    resolved_ = std::make_unique<const Resolved>(std::move(resolved));
  }
  return *resolved_;
}

std::optional<Choice> PyScene::choice() const {
  if (!scene_.auto_regions) return {};
  const Resolved& now = resolved();
  return Choice{now.setup.region_of, now.setup.selective_mass, now.setup.expandable, now.proposal,
                now.warnings};
}

}  // namespace lobe::python
