#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/quality.h"
#include "lobe/mesh/refine.h"
#include "scene.h"

namespace lobe::python {
namespace {

std::shared_ptr<TetMesh> mesh_of(const py::object& points, const py::object& tets, const py::object& labels) {
  auto mesh = std::make_shared<TetMesh>();
  mesh->points = columns3(points, "points");
  mesh->tets = integers(tets, "tets", 4);
  if (!labels.is_none()) {
    for (Index label : indices(labels, "labels", std::numeric_limits<Index>::max()))
      mesh->labels.push_back(label);
    if (Index(mesh->labels.size()) != mesh->tet_count())
      throw InputError("labels",
                       std::to_string(mesh->labels.size()) +
                           " of them, must be one per tetrahedron: " + std::to_string(mesh->tet_count()));
  }
  prepare(*mesh, "mesh");
  return mesh;
}

std::shared_ptr<TetMesh> shared(TetMesh mesh) { return std::make_shared<TetMesh>(std::move(mesh)); }

}  // namespace

void bind_mesh(py::module_& module) {
  py::class_<TetMesh, std::shared_ptr<TetMesh>> mesh(module, "Mesh",
                                                     "Tetrahedra at rest. It does not change.");
  mesh.def(py::init(&mesh_of), py::arg("points"), py::arg("tets"), py::arg("labels") = py::none(),
           "Makes a mesh of arrays. points: (n, 3) [m]; tets: (m, 4) indices; labels: (m,) whole numbers "
           "from 0, none: 0. Arrays are "
           "copied;\n"
           "tetrahedra that are inside out are turned round. Raises InputError for what is no mesh.")
      .def_property_readonly(
          "points", [](py::object self) { return read_only(self.cast<TetMesh&>().points, self); },
          "(n, 3) float64, rest positions of the vertices [m], read-only.")
      .def_property_readonly(
          "tets",
          [](py::object self) {
            const TetMesh& mesh = self.cast<TetMesh&>();
            return read_only(mesh.tets.data(), {mesh.tets.cols(), 4}, self);
          },
          "(m, 4) int32, vertices of each tetrahedron, positively oriented, read-only.")
      .def_property_readonly(
          "labels",
          [](py::object self) {
            const TetMesh& mesh = self.cast<TetMesh&>();
            return read_only(mesh.labels.data(), {py::ssize_t(mesh.labels.size())}, self);
          },
          "(m,) int32, the label of each tetrahedron, read-only.")
      .def_property_readonly("volume", &total_volume, "The volume of all tetrahedra [m³].")
      .def(
          "save", [](const TetMesh& mesh, const std::filesystem::path& file) { write_mesh(file, mesh); },
          py::arg("file"), "Writes it as a file, by extension: .vtu, .vtk, .msh, .msh2, .mesh, .node.")
      .def(py::pickle(&mesh_state, &mesh_of_state))
      .def("__repr__", [](const TetMesh& mesh) {
        return "<lobe.Mesh: " + std::to_string(mesh.vertex_count()) + " vertices, " +
               std::to_string(mesh.tet_count()) + " tetrahedra>";
      });
  add_copies(mesh);
  module.def(
      "read_mesh", [](const std::filesystem::path& file) { return shared(read_mesh(file).mesh); },
      py::arg("file"),
      "Reads a mesh by extension: .vtu, .vtk, .msh, .msh2, .mesh, .node, .ele. Raises InputError.");
  module.def(
      "box_mesh",
      [](const std::array<double, 3>& size, const std::array<int, 3>& cells) {
        for (int i = 0; i < 3; ++i)
          if (!(size[i] > 0) || cells[i] < 1)
            throw InputError("box_mesh", "sizes must be above 0, and cells 1 or more");
        return shared(box_mesh({size[0], size[1], size[2]}, cells[0], cells[1], cells[2]));
      },
      py::arg("size"), py::arg("cells"),
      "Makes a box from the origin to `size` [m], of cells × 6 tetrahedra.");
}

}  // namespace lobe::python
