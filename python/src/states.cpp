// Meshes and scenes as tuples, for pickle.
#include <pybind11/stl.h>

#include "lobe/error.h"
#include "lobe/scene/write_scene.h"
#include "scene.h"

namespace lobe::python {
namespace {

py::bytes bytes_of(const std::vector<RegionModel>& models) {
  return py::bytes(reinterpret_cast<const char*>(models.data()), models.size());
}
std::vector<RegionModel> models_of(const py::handle& bytes) {
  std::vector<RegionModel> models;
  for (const char code : bytes.cast<std::string>()) {
    if (std::size_t(code) >= region_model_names.size()) throw InputError("regions", "have an unknown code");
    models.push_back(RegionModel(code));
  }
  return models;
}

py::object proposal_state(const std::optional<Proposal>& proposal) {
  if (!proposal) return py::none();
  py::list gestures;
  for (const GestureOutcome& g : proposal->gestures)
    gestures.append(py::make_tuple(g.name, g.reached, g.predicted, g.measured));
  return py::make_tuple(bytes_of(proposal->region_of), proposal->linear_share, proposal->predicted_speedup,
                        proposal->measured_speedup, gestures, proposal->notes);
}
std::optional<Proposal> proposal_of(const py::object& state) {
  if (state.is_none()) return {};
  const py::tuple of = state;
  Proposal proposal{
      models_of(of[0]), of[1].cast<double>(), of[2].cast<double>(), of[3].cast<double>(), {}, {}};
  for (const py::handle& entry : of[4]) {
    const auto gesture = py::reinterpret_borrow<py::tuple>(entry);
    proposal.gestures.push_back({gesture[0].cast<std::string>(), gesture[1].cast<double>(),
                                 gesture[2].cast<double>(), gesture[3].cast<double>()});
  }
  proposal.notes = of[5].cast<std::vector<std::string>>();
  return proposal;
}

py::object choice_state(const std::optional<Choice>& choice) {
  if (!choice) return py::none();
  return py::make_tuple(bytes_of(choice->region_of), choice->selective_mass, choice->expandable,
                        proposal_state(choice->proposal), choice->warnings);
}
std::optional<Choice> choice_of(const py::object& state) {
  if (state.is_none()) return {};
  const py::tuple of = state;
  return Choice{models_of(of[0]), of[1].cast<int>(), of[2].cast<bool>(), proposal_of(of[3]),
                of[4].cast<std::vector<std::string>>()};
}

}  // namespace

py::tuple mesh_state(const TetMesh& mesh) {
  const py::ssize_t tets = mesh.tet_count();
  return py::make_tuple(
      copied(mesh.points), py::array_t<int>({tets, py::ssize_t{4}}, mesh.tets.data()),
      py::array_t<int>(py::ssize_t(mesh.labels.size()), mesh.labels.data()), copied(mesh.fibres),
      mesh.bodies.names,
      py::bytes(reinterpret_cast<const char*>(mesh.bodies.of.data()), mesh.bodies.of.size()));
}

std::shared_ptr<TetMesh> mesh_of_state(const py::tuple& state) {
  auto mesh = std::make_shared<TetMesh>();
  mesh->points = columns3(state[0], "points");
  mesh->tets = integers(state[1], "tets", 4);
  const auto labels = state[2].cast<py::array_t<int>>();
  mesh->labels.assign(labels.data(), labels.data() + labels.size());
  mesh->fibres = columns3(state[3], "fibres");
  mesh->bodies.names = state[4].cast<std::vector<std::string>>();
  const auto bodies = state[5].cast<std::string>();
  mesh->bodies.of.assign(bodies.begin(), bodies.end());
  prepare(*mesh, "mesh");
  return mesh;
}

py::tuple scene_state(const PyScene& scene) {
  const py::object mesh = scene.mesh() ? py::object(mesh_state(*scene.mesh())) : py::none();
  return py::make_tuple(to_json(scene.scene()), std::filesystem::absolute(scene.scene().file).string(), mesh,
                        choice_state(scene.choice()));
}

std::shared_ptr<PyScene> scene_of_state(const py::tuple& state) {
  std::shared_ptr<const TetMesh> mesh;
  if (!state[2].is_none()) mesh = mesh_of_state(state[2]);
  return std::make_shared<PyScene>(parse_scene(state[0].cast<std::string>(), state[1].cast<std::string>()),
                                   std::move(mesh), choice_of(state[3]));
}

}  // namespace lobe::python
