#include "lobe/error.h"
#include "world.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace lobe::python {
namespace {

// A tool that a script holds.
struct PyTool {
  std::shared_ptr<PyWorld> world;
  ToolId id;
};
struct PyGrasp : PyTool {};
struct PyCautery : PyTool {};
struct PyScalpel : PyTool {};

// Without the GIL, and without anybody else in this world.
template <class Work>
auto exclusively(PyWorld& world, Work&& work) {
  const py::gil_scoped_release others_run;
  const auto lock = world.claim();
  return work();
}

void apply(PyWorld& world, const Command& command) {
  exclusively(world, [&] { world.apply(command); });
}

RegionModel model_of(const std::string& name) {
  for (std::size_t i = 0; i < region_model_names.size(); ++i)
    if (name == region_model_names[i]) return RegionModel(i);
  throw InputError("model", "\"" + name + "\", must be one of region_models");
}

PyGrasp take(std::shared_ptr<PyWorld> world, const py::object& vertices, const py::object& near,
             double radius, const std::string& name) {
  if (vertices.is_none() == near.is_none())
    throw InputError("grasp", "wants either vertices, or near and radius");
  TakeHold command{name, {}};
  if (vertices.is_none()) {
    const Vec3d centre = vector3(near, "near");
    if (!(radius > 0)) throw InputError("radius", "must be above 0 m");
    const Mat3X<double> x = exclusively(*world, [&] { return world->positions(); });
    const Topology& topology = world->elements().topology;
    for (Index v = 0; v < x.cols(); ++v)
      if (!topology.around(v).empty() && (x.col(v) - centre).norm() <= radius) command.vertices.push_back(v);
    if (command.vertices.empty()) throw InputError("near", "no vertex lies within the radius");
  } else {
    command.vertices = indices(vertices, "vertices", world->elements().topology.vertex_count());
  }
  const ToolId id = exclusively(*world, [&] {
    const ToolId next = world->tools().next_id();
    world->apply(command);
    return next;
  });
  return {{std::move(world), id}};
}

PyCautery bring(std::shared_ptr<PyWorld> world, const py::object& position, double radius,
                const std::string& name) {
  const Vec3d tip = vector3(position, "position");
  const ToolId id = exclusively(*world, [&] {
    const ToolId next = world->tools().next_id();
    world->apply(BringCautery{name, radius, tip});
    return next;
  });
  return {{std::move(world), id}};
}

PyScalpel bring_scalpel(std::shared_ptr<PyWorld> world, const py::object& tip, const py::object& heel,
                        double snap, bool along_faces, const std::string& name) {
  const BladePose pose{vector3(tip, "tip"), vector3(heel, "heel")};
  const ToolId id = exclusively(*world, [&] {
    const ToolId next = world->tools().next_id();
    world->apply(BringScalpel{name, pose, snap, along_faces});
    return next;
  });
  return {{std::move(world), id}};
}

void lead(const PyTool& self, const py::object& position, const py::object& orientation) {
  Lead command{self.id, {vector3(position, "position")}};
  if (!orientation.is_none()) {
    const py::array_t<double, py::array::c_style | py::array::forcecast> q(orientation);
    if (q.ndim() != 1 || q.shape(0) != 4) throw InputError("orientation", "must be four numbers x, y, z, w");
    command.target.orientation = Eigen::Map<const Eigen::Vector4d>(q.data());
  }
  apply(*self.world, command);
}

const Grasp& grasp_of(const PyTool& tool) { return *tool.world->tools().grasp(tool.id); }

void bind_reports(py::module_& module) {
  py::class_<Condition>(module, "Condition", "Something that happened in a frame, with a remedy.")
      .def_property_readonly("kind", [](const Condition& c) { return name(c.kind); })
      .def_readonly("text", &Condition::text, "one line: place, figures, remedy")
      .def_readonly("time", &Condition::time, "[s]")
      .def("__repr__",
           [](const Condition& c) { return "<" + std::string(name(c.kind)) + ": " + c.text + ">"; });
  py::class_<Transitions>(
      module, "Transitions",
      "How often vertices of reduced regions were embedded or became full, and by what that "
      "changed energies [J].")
      .def_readonly("count", &Transitions::count)
      .def_readonly("kinetic", &Transitions::kinetic)
      .def_readonly("elastic", &Transitions::elastic)
      .def_readonly("loads", &Transitions::loads)
      .def_property_readonly("total", &Transitions::total);
  py::class_<Report>(module, "Report", "Of one frame.")
      .def_readonly("ok", &Report::ok, "False: the world could not be advanced; the conditions say why")
      .def_readonly("steps", &Report::steps)
      .def_readonly("time_step", &Report::time_step, "the smallest that was taken [s]")
      .def_readonly("time_step_limit", &Report::time_step_limit, "[s]")
      .def_readonly("reruns", &Report::reruns, "of the frame, with smaller steps")
      .def_readonly("tets_removed", &Report::tets_removed)
      .def_readonly("tets_copied", &Report::tets_copied, "parts that scalpels have cut off tetrahedra")
      .def_readonly("cut_area", &Report::cut_area, "that scalpels have opened, at rest [m²]")
      .def_readonly("transitions", &Report::transitions, "of reduced regions, since the last report")
      .def_readonly("smallest_volume_ratio", &Report::smallest_volume_ratio, "of non-linear tetrahedra")
      .def_readonly("conditions", &Report::conditions);
  py::class_<PyCheckpoint>(module, "Checkpoint", "All that has changed in a world since it was built.")
      .def(
          "save",
          [](const PyCheckpoint& self, const std::filesystem::path& file) {
            std::visit([&](const auto& checkpoint) { write_checkpoint(file, checkpoint); }, self.of);
          },
          py::arg("file"));
}

void bind_tools(py::module_& module) {
  py::class_<PyGrasp>(module, "Grasp", "Holds vertices. Made by World.grasp().")
      .def(
          "move_to",
          [](const PyGrasp& self, const py::object& position, const py::object& orientation) {
            lead(self, position, orientation);
          },
          py::arg("position"), py::arg("orientation") = py::none(),
          "Where its centre is to be at the end of the next frame [m], and how it is turned since it took "
          "hold: a unit\n"
          "quaternion (x, y, z, w).")
      .def(
          "release", [](const PyGrasp& self) { apply(*self.world, LetGo{self.id}); },
          "At the start of the next frame.")
      .def_property_readonly("vertices",
                             [](const PyGrasp& self) {
                               const std::vector<Index>& v = grasp_of(self).vertices;
                               return py::array_t<Index>(py::ssize_t(v.size()), v.data());
                             })
      .def_property_readonly(
          "position",
          [](const PyGrasp& self) {
            const Grasp& grasp = grasp_of(self);
            if (grasp.path.empty()) throw InputError("position", "is known after the first frame");
            return copied(Vec3d(grasp.centre + path_at(grasp.path.recent(), self.world->time())));
          },
          "of its centre [m]; after the first frame")
      .def_property_readonly(
          "force", [](const PyGrasp& self) { return copied(grasp_of(self).force); },
          "that it exerts on the body, mean over the last frame [N]")
      .def_property_readonly(
          "torque", [](const PyGrasp& self) { return copied(grasp_of(self).torque); },
          "the same about its centre [N m]");
  py::class_<PyCautery>(module, "Cautery",
                        "Burns what its spherical tip touches, while it is on. Made by World.cautery().")
      .def(
          "move_to",
          [](const PyCautery& self, const py::object& position) {
            apply(*self.world, Lead{self.id, {vector3(position, "position")}});
          },
          py::arg("position"), "Moves its tip to this position by the end of the next frame [m].")
      .def(
          "switch",
          [](const PyCautery& self, bool on) {
            apply(*self.world, SwitchTool{self.id, on});
          },
          py::arg("on"))
      .def(
          "release", [](const PyCautery& self) { apply(*self.world, LetGo{self.id}); }, "Takes it away.");
}

void bind_scalpel(py::module_& module) {
  py::class_<PyScalpel>(
      module, "Scalpel",
      "Cuts with an edge from its tip to its heel, while it is on. Made by World.scalpel().")
      .def(
          "move_to",
          [](const PyScalpel& self, const py::object& position, const py::object& orientation) {
            lead(self, position, orientation);
          },
          py::arg("position"), py::arg("orientation") = py::none(),
          "Where its tip is to be at the end of the next frame [m], and how the edge is turned since it was "
          "brought: a\n"
          "unit quaternion (x, y, z, w).")
      .def(
          "switch",
          [](const PyScalpel& self, bool on) {
            apply(*self.world, SwitchTool{self.id, on});
          },
          py::arg("on"), "Whether it cuts.")
      .def(
          "release", [](const PyScalpel& self) { apply(*self.world, LetGo{self.id}); }, "Takes it away.");
}

void bind_edits(py::class_<PyWorld, std::shared_ptr<PyWorld>>& world) {
  world
      .def("grasp", &take, py::arg("vertices") = py::none(), py::kw_only(), py::arg("near") = py::none(),
           py::arg("radius") = 0.0, py::arg("name") = "hand",
           "Takes hold, at the start of the next frame, of vertices (indices or a mask), or of all within "
           "the radius [m]\n"
           "of a point [m].")
      .def("cautery", &bring, py::arg("position"), py::kw_only(), py::arg("radius"),
           py::arg("name") = "cautery", "Adds a cautery, switched off; the radius is its tip's [m].")
      .def(
          "scalpel", &bring_scalpel, py::arg("tip"), py::arg("heel"), py::kw_only(), py::arg("snap") = 0.1,
          py::arg("along_faces") = false, py::arg("name") = "scalpel",
          "Adds a scalpel, which does not cut yet; its edge leads from tip to heel [m]. A vertex nearer to "
          "the cut than\n"
          "the share `snap` of its shortest edge lies on it; along_faces: only faces that the mesh has open.")
      .def(
          "remove_tets",
          [](PyWorld& self, const py::object& tets) {
            apply(self, RemoveTets{indices(tets, "tets", self.elements().topology.tet_count())});
          },
          py::arg("tets"), "Indices or a mask.")
      .def(
          "set_region",
          [](PyWorld& self, const py::object& tets, const std::string& model) {
            apply(self,
                  SetRegion{indices(tets, "tets", self.elements().topology.tet_count()), model_of(model)});
          },
          py::arg("tets"), py::arg("model"), "Indices or a mask, and one of region_models.")
      .def(
          "set_forces",
          [](PyWorld& self, const py::object& vertices, const py::object& forces) {
            const auto at = indices(vertices, "vertices", self.elements().topology.vertex_count());
            const Mat3X<double> f = columns3(forces, "forces");
            if (f.cols() != Index(at.size())) throw InputError("forces", "must be one per vertex");
            SetForces command;
            for (std::size_t i = 0; i < at.size(); ++i)
              command.forces.push_back({at[i], f.col(Eigen::Index(i))});
            apply(self, command);
          },
          py::arg("vertices"), py::arg("forces"), "(k, 3) [N], in place of those that were set before.")
      .def(
          "set_springs",
          [](PyWorld& self, const py::object& vertices, const py::object& points, double stiffness) {
            const auto at = indices(vertices, "vertices", self.elements().topology.vertex_count());
            const Mat3X<double> p = columns3(points, "points");
            if (p.cols() != Index(at.size())) throw InputError("points", "must be one per vertex");
            SetSprings command;
            for (std::size_t i = 0; i < at.size(); ++i)
              command.springs.push_back({at[i], stiffness, p.col(Eigen::Index(i))});
            apply(self, command);
          },
          py::arg("vertices"), py::arg("points"), py::arg("stiffness"),
          "From vertices to points (k, 3) [m], each of the stiffness [N/m], in place of those that were set "
          "before.")
      .def(
          "move_springs",
          [](PyWorld& self, const py::object& points) {
            apply(self, MoveSprings{columns3(points, "points")});
          },
          py::arg("points"), "Where they are to be at the end of the next frame, (k, 3) [m].");
}

}  // namespace

void bind_world(py::module_& module) {
  bind_reports(module);
  bind_tools(module);
  bind_scalpel(module);
  py::class_<PyWorld, std::shared_ptr<PyWorld>> world(
      module, "World",
      "A body that is simulated. Calls by two threads at a time are refused; the GIL is released meanwhile.");
  world
      .def(py::init(&make_world), py::arg("scene"), py::kw_only(), py::arg("threads") = 1,
           py::arg("precision") = py::none(),
           "precision: \"single\" or \"double\", in place of the scene's. Raises InputError.")
      .def(
          "advance",
          [](PyWorld& self, double duration) {
            return exclusively(self, [&] { return self.advance(duration); });
          },
          py::arg("duration"),
          "Simulates one frame [s]. Does not raise for what happens in it: look at the report.")
      .def_property_readonly("time", &PyWorld::time, "[s]")
      .def_property_readonly(
          "scene", [](const PyWorld& self) { return self.scene; }, "The Scene that it was built from.")
      .def_property_readonly("precision",
                             [](const PyWorld& self) { return self.in_double() ? "double" : "single"; })
      .def_property_readonly(
          "tet_count", [](const PyWorld& self) { return self.elements().topology.alive_count(); },
          "of those that are left")
      .def_property_readonly("vertex_count",
                             [](const PyWorld& self) { return self.elements().topology.vertex_count(); })
      .def(
          "snapshot", [](PyWorld& self) { return exclusively(self, [&] { return self.snapshot(); }); },
          "A copy of the present state, which does not change.")
      .def(
          "forces", [](PyWorld& self) { return copied(exclusively(self, [&] { return self.forces(); })); },
          "(n, 3) internal and external forces on vertices at the present state [N]; a copy")
      .def(
          "energies",
          [](PyWorld& self) {
            const Energies e = exclusively(self, [&] { return self.energies(); });
            py::dict result;
            result["kinetic"] = e.kinetic;
            result["elastic_linear"] = e.elastic_linear;
            result["elastic_nonlinear"] = e.elastic_nonlinear;
            result["loads"] = e.loads;
            result["applied"] = e.applied;
            result["total"] = e.total();
            return result;
          },
          "A dictionary [J].")
      .def(
          "time_step_limit",
          [](PyWorld& self) { return exclusively(self, [&] { return self.time_step_limit(); }); },
          "2/ω_max at the present state [s]")
      .def("save", [](PyWorld& self) { return exclusively(self, [&] { return self.save(); }); })
      .def(
          "restore",
          [](PyWorld& self, const PyCheckpoint& checkpoint) {
            exclusively(self, [&] { self.restore(checkpoint); });
          },
          py::arg("checkpoint"), "Raises InputError for one of another scene, and changes nothing then.");
  bind_edits(world);
}

}  // namespace lobe::python
