#include "snapshot.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "lobe/text.h"
#include "scene.h"

namespace lobe::python {
namespace {

// get(snapshot) of either precision.
template <class Get>
auto of(const PySnapshot& snapshot, Get&& get) {
  return std::visit([&](const auto& value) { return get(*value); }, snapshot.of);
}
template <class Get>
auto of(const PySurface& surface, Get&& get) {
  return of(*surface.snapshot, [&](const auto& value) { return get(value.surface); });
}

const SurfaceMesh& mesh_of(const PySurface& surface) {
  return *of(surface, [](const auto& of) { return of.mesh.get(); });
}

// One per triangle, by what has opened it (SurfaceMesh::cut).
template <class Is>
py::array flags_of(const py::handle& surface, Is&& is) {
  const auto& cut = mesh_of(surface.cast<PySurface&>()).cut;
  py::array_t<bool> flags(py::ssize_t(cut.size()));
  std::transform(cut.begin(), cut.end(), flags.mutable_data(), is);
  py::detail::array_proxy(flags.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return flags;
}

py::list tools_of(const PySnapshot& snapshot) {
  return of(snapshot, [](const auto& s) {
    py::list tools;
    for (const ToolSnapshot& tool : s.tools) {
      py::dict entry;
      entry["name"] = tool.name;
      entry["type"] = tool.type;
      entry["position"] = copied(tool.position);
      entry["orientation"] =
          py::array(py::dtype::of<double>(), {py::ssize_t{4}}, tool.orientation.coeffs().data());
      entry["force"] = copied(tool.force);
      entry["torque"] = copied(tool.torque);
      tools.append(entry);
    }
    return tools;
  });
}

void bind_surface(py::module_& module) {
  py::class_<PySurface, std::shared_ptr<PySurface>>(
      module, "Surface",
      "The boundary of the body in a snapshot. A vertex where a cut meets the skin is two vertices of it.")
      .def_property_readonly(
          "x",
          [](py::object self) {
            return of(self.cast<PySurface&>(), [&](const auto& s) { return read_only(s.x, self); });
          },
          "(k, 3) current positions of its vertices [m], read-only.")
      .def_property_readonly(
          "normals",
          [](py::object self) {
            return of(self.cast<PySurface&>(), [&](const auto& s) { return read_only(s.normals, self); });
          },
          "(k, 3) unit normals at its vertices, outwards, read-only.")
      .def_property_readonly(
          "triangles",
          [](py::object self) {
            const auto& triangles = mesh_of(self.cast<PySurface&>()).triangles;
            return read_only(reinterpret_cast<const int*>(triangles.data()),
                             {py::ssize_t(triangles.size()), 3}, self);
          },
          "(t, 3) int32, vertices of this surface, counter-clockwise seen from outside, read-only.")
      .def_property_readonly(
          "region",
          [](py::object self) {
            const auto& region = mesh_of(self.cast<PySurface&>()).region;
            return read_only(reinterpret_cast<const std::uint8_t*>(region.data()),
                             {py::ssize_t(region.size())}, self);
          },
          "(t,) uint8, the code of the model of each triangle's tetrahedron, read-only.")
      .def_property_readonly(
          "body",
          [](py::object self) {
            const auto& body = mesh_of(self.cast<PySurface&>()).body;
            return read_only(body.data(), {py::ssize_t(body.size())}, self);
          },
          "(t,) uint8, the place of each triangle's body in World.bodies, 0 where there are none, read-only.")
      .def_property_readonly(
          "cut", [](py::object self) { return flags_of(self, [](std::uint8_t cut) { return cut != 0; }); },
          "(t,) bool, whether a cut has made the triangle, read-only.")
      .def_property_readonly(
          "burnt", [](py::object self) { return flags_of(self, [](std::uint8_t cut) { return cut == 2; }); },
          "(t,) bool, whether a cut that has removed tissue has made the triangle, read-only.")
      .def_property_readonly(
          "vertex",
          [](py::object self) {
            const auto& vertex = mesh_of(self.cast<PySurface&>()).mesh_vertex;
            return read_only(vertex.data(), {py::ssize_t(vertex.size())}, self);
          },
          "(k,) int32, the vertex of the mesh that each is, read-only.")
      .def_property_readonly(
          "revision", [](const PySurface& self) { return mesh_of(self).revision; },
          "A number that grows with every change of anything but positions and normals.")
      .def("__repr__", [](const PySurface& self) {
        const SurfaceMesh& mesh = mesh_of(self);
        return "<lobe.Surface: " + std::to_string(mesh.vertex_count()) + " vertices, " +
               std::to_string(mesh.triangle_count()) + " triangles>";
      });
}

}  // namespace

void bind_snapshot(py::module_& module) {
  static_assert(sizeof(bool) == 1 && sizeof(RegionModel) == 1 && sizeof(Eigen::Vector3i) == 3 * sizeof(int));
  bind_surface(module);
  py::class_<PySnapshot, std::shared_ptr<PySnapshot>>(
      module, "Snapshot", "A moment of a world. It owns its arrays, which outlive cuts and the world.")
      .def_property_readonly(
          "time", [](const PySnapshot& self) { return of(self, [](const auto& s) { return s.time; }); },
          "The simulated time of the moment [s].")
      .def_property_readonly(
          "u",
          [](py::object self) {
            return of(self.cast<PySnapshot&>(), [&](const auto& s) { return read_only(s.u, self); });
          },
          "(n, 3) displacements of the vertices [m], float32 or float64 as the world, read-only.")
      .def_property_readonly(
          "v",
          [](py::object self) {
            return of(self.cast<PySnapshot&>(), [&](const auto& s) { return read_only(s.v, self); });
          },
          "(n, 3) velocities of the vertices [m/s], read-only.")
      .def_property_readonly(
          "surface", [](std::shared_ptr<PySnapshot> self) { return PySurface{std::move(self)}; },
          "The Surface of the body at that moment.")
      .def_property_readonly(
          "tools", &tools_of,
          "A list with a dictionary for each tool: name, type, position [m], orientation (x, y, z, w), force "
          "[N] and torque\n[N m] on the tool, by the body.")
      .def("__repr__", [](const PySnapshot& self) {
        return of(self, [](const auto& s) {
          return "<lobe.Snapshot: " + rounded(s.time) + " s, " + std::to_string(s.u.cols()) + " vertices>";
        });
      });
}

}  // namespace lobe::python
