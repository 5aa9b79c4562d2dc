#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/run/run.h"
#include "lobe/run/solve.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/listed_regions.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"
#include "scene.h"

namespace lobe::python {
namespace {

py::object json() { return py::module_::import("json"); }

// numpy's arrays and numbers, which json does not know, as lists.
std::string text_of(const py::dict& document) {
  const py::cpp_function as_list = [](const py::object& value) -> py::object {
    if (py::hasattr(value, "tolist")) return value.attr("tolist")();
    throw py::type_error("a scene cannot hold a " + std::string(py::str(py::type::of(value))));
  };
  return json().attr("dumps")(document, py::arg("default") = as_list).cast<std::string>();
}

std::vector<RegionModel> models_of(const py::object& regions, Index tets) {
  std::vector<RegionModel> models;
  const py::array array = py::array::ensure(regions);
  if (!array || array.ndim() != 1 || array.shape(0) != tets ||
      (array.dtype().kind() != 'u' && array.dtype().kind() != 'i'))
    throw InputError("regions",
                     "must be a whole number for each of the " + std::to_string(tets) + " tetrahedra");
  for (Index code : indices(array, "regions", Index(region_model_names.size())))
    models.push_back(RegionModel(code));
  return models;
}

// In its folder, wherever the process goes later.
std::shared_ptr<PyScene> placed(Scene scene, std::shared_ptr<TetMesh> mesh) {
  scene.file = std::filesystem::absolute(scene.file).lexically_normal();
  return std::make_shared<PyScene>(std::move(scene), std::move(mesh));
}

std::shared_ptr<PyScene> scene_of(const py::object& document, std::shared_ptr<TetMesh> mesh,
                                  const py::object& regions, const std::filesystem::path& folder) {
  std::string text;
  if (py::isinstance<py::str>(document)) {
    text = document.cast<std::string>();
  } else if (py::isinstance<py::dict>(document)) {
    const py::dict copy(document.attr("copy")());
    if (mesh && copy.contains("bodies"))
      throw InputError("mesh", "the document has \"bodies\", whose meshes are files");
    if (mesh && !copy.contains("mesh")) copy["mesh"] = "in memory";
    text = text_of(copy);
  } else {
    throw InputError("scene", "must be a dictionary or JSON text");
  }
  Scene scene = parse_scene(text, folder / "scene.json");
  if (!regions.is_none()) {
    const Index tets = mesh ? mesh->tet_count() : read_scene_mesh(scene).mesh.tet_count();
    list_regions(models_of(regions, tets), scene);
  }
  return placed(std::move(scene), std::move(mesh));
}

// With absolute paths, except that of a mesh in memory.
Scene anywhere(const PyScene& self) {
  Scene scene = with_absolute_paths(self.scene());
  if (self.mesh()) scene.mesh = self.scene().mesh;
  return scene;
}

// A mesh in memory that has bodies, as that of another scene may have, is written body by body.
void save_mesh(const TetMesh& mesh, const std::filesystem::path& folder, const std::string& stem,
               Scene& scene) {
  if (!mesh.bodies.any()) {
    scene.mesh = stem + ".vtu";
    return write_vtu(folder / scene.mesh, mesh);
  }
  TetMesh in_metres = mesh;
  in_metres.points *= scene.mesh_scale;
  for (const std::string& name : mesh.bodies.names) scene.bodies.push_back({.name = name, .mesh = {}});
  save_scene_mesh(in_metres, folder, stem, scene);
}

void save_scene(const PyScene& self, const std::filesystem::path& file, bool chosen_regions) {
  Scene scene = anywhere(self);
  if (chosen_regions) state_regions(self.resolved().setup, scene);
  const py::gil_scoped_release others_run;
  if (self.mesh()) {
    save_mesh(*self.mesh(), file.parent_path(), file.stem().string(), scene);
  }
  io::write_file(file, to_json(scene));
}

std::string describe_scene(const PyScene& self) {
  const std::string name = self.scene().name.empty() ? "" : " \"" + self.scene().name + "\"";
  std::string mesh;
  if (self.mesh())
    mesh = std::to_string(self.mesh()->tet_count()) + " tetrahedra in memory";
  else
    for (const std::filesystem::path& file : mesh_paths(self.scene()))
      mesh += (mesh.empty() ? "" : ", ") + file.string();
  return "<lobe.Scene" + name + ": " + mesh + ">";
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<PyScene, std::shared_ptr<PyScene>> scene(
      module, "Scene", "What is simulated (docs/scene.md). It does not change.");
  scene
      .def(py::init(&scene_of), py::arg("document"), py::arg("mesh") = py::none(), py::kw_only(),
           py::arg("regions") = py::none(), py::arg("folder") = ".",
           "Makes a scene. document: a dictionary, in which numpy arrays may stand for lists, or JSON text. "
           "mesh: in place "
           "of the\n"
           "file that the document names. regions: (m,) numbers of models per tetrahedron "
           "(docs/guide/regions.md),\n"
           "in place of the document's. folder: what relative paths "
           "are relative "
           "to. Raises "
           "InputError\n"
           "with all faults.")
      .def_property_readonly(
          "mesh", [](const PyScene& self) { return std::make_shared<TetMesh>(self.resolved().setup.mesh); },
          "The Mesh of the scene; a copy.")
      .def_property_readonly(
          "regions",
          [](py::object self) {
            const std::vector<RegionModel>& models = self.cast<PyScene&>().resolved().setup.region_of;
            return read_only(reinterpret_cast<const std::uint8_t*>(models.data()),
                             {py::ssize_t(models.size())}, self);
          },
          "(m,) uint8, the code of the model of each tetrahedron, an index into region_models, read-only.")
      .def_property_readonly(
          "warnings", [](const PyScene& self) { return self.resolved().warnings; },
          "A list of lines: what is unusual in the scene, though it can run.")
      .def(
          "check",
          [](const PyScene& self) {
            return json().attr("loads")(describe_json(self.scene(), self.resolved()));
          },
          "Returns what will be run, as `lobe check --json` prints it: a dictionary. Raises InputError.")
      .def(
          "to_dict", [](const PyScene& self) { return json().attr("loads")(to_json(anywhere(self))); },
          "Returns the scene as it was understood, a dictionary with all defaults and with absolute paths.")
      .def("save", &save_scene, py::arg("file"), py::kw_only(), py::arg("chosen_regions") = false,
           "Writes it as a file, with absolute paths. A mesh in memory is written beside it, as .vtu. "
           "chosen_regions: with the\nregions that lobe has chosen, where the scene leaves the choice to it. "
           "Raises InputError.")
      .def(py::pickle(&scene_state, &scene_of_state))
      .def("__repr__", &describe_scene);
  add_copies(scene);
  module.def(
      "read_scene", [](const std::filesystem::path& file) { return placed(read_scene(file), nullptr); },
      py::arg("file"), "Reads a scene file. Raises InputError with all faults.");
  module.def(
      "run",
      [](const PyScene& scene, const std::filesystem::path& folder, int threads) {
        const Resolved& resolved = scene.resolved();
        RunOptions options;
        options.directory = folder;
        options.threads = threads;
        RunResult result;
        {
          const py::gil_scoped_release others_run;
          result = run_scene(scene.scene(), resolved, options);
        }
        py::object report = json().attr("loads")(
            py::module_::import("pathlib").attr("Path")(result.report.string()).attr("read_text")());
        return report;
      },
      py::arg("scene"), py::arg("folder"), py::arg("threads") = 1,
      "Plays the scene as `lobe run` does, with everything written to the folder; returns its report, a "
      "dictionary.");
  module.attr("region_models") =
      std::apply([](auto... name) { return py::make_tuple(name...); }, region_model_names);
}

}  // namespace lobe::python
