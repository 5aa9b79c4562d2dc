#include <pybind11/stl.h>

#include "lobe/error.h"
#include "tools.h"

namespace lobe::python {
namespace {

// Returns work(world) for the world that the handle is of.
template <class Work>
auto use(const PyTool& tool, Work&& work) {
  return tool.world->use([&](AnyWorld& world) {
    if (tool.times_restored != tool.world->times_restored())
      throw InputError("tool",
                       "this handle was made before World.restore(); World.tools has the present ones");
    return work(world);
  });
}

void apply(const PyTool& tool, const Command& command) {
  use(tool, [&](AnyWorld& world) { world.apply(command); });
}

template <class Work>
auto use_grasp(const PyTool& tool, Work&& work) {
  return use(tool, [&](AnyWorld& world) {
    const Grasp* grasp = world.tools().grasp(tool.id);
    if (!grasp) throw InputError("tool", "was let go already");
    return work(world, *grasp);
  });
}

void lead(const PyTool& self, const py::object& position, const py::object& orientation) {
  Lead command{self.id, {vector3(position, "position")}};
  if (!orientation.is_none()) {
    const py::array_t<double, py::array::c_style | py::array::forcecast> q(orientation);
    if (q.ndim() != 1 || q.shape(0) != 4) throw InputError("orientation", "must be four numbers x, y, z, w");
    command.target.orientation = Eigen::Map<const Eigen::Vector4d>(q.data());
  }
  apply(self, command);
}

void let_go(const PyTool& self) { apply(self, LetGo{self.id}); }
void turn_on(const PyTool& self, bool on) { apply(self, SwitchTool{self.id, on}); }

std::string name_of(const PyTool& self) {
  return use(self, [&](AnyWorld& world) {
    std::string name;
    if (!world.tools().visit(self.id, [&](const auto& tool) { name = tool.name; }))
      throw InputError("tool", "was let go already");
    return name;
  });
}

// Also of a handle that cannot be used now.
std::string describe_tool(const PyTool& self, const char* type, const char* on, const char* off) {
  std::string text = std::string("<lobe.") + type;
  try {
    text += use(self, [&](AnyWorld& world) {
      std::string state = ": was let go";
      world.tools().visit(self.id, [&](const auto& tool) {
        if (!tool.has_gone()) state = " \"" + tool.name + "\": " + (tool.is_on() ? on : off);
      });
      return state;
    });
  } catch (const InputError&) {
    text += ": of before a restore()";
  } catch (const std::runtime_error&) {
    text += ": another thread is using its world";
  }
  return text + ">";
}

// ---- What is read of a grasp

py::array held_vertices(const PyGrasp& self) {
  const auto vertices = use_grasp(self, [](AnyWorld&, const Grasp& grasp) { return grasp.vertices; });
  return py::array_t<Index>(py::ssize_t(vertices.size()), vertices.data());
}

py::array position_of(const PyGrasp& self) {
  return copied(use_grasp(self, [](AnyWorld& world, const Grasp& grasp) {
    if (grasp.path.empty()) throw InputError("position", "is known after the first frame");
    return Vec3d(grasp.centre + path_at(grasp.path.recent(), world.time()));
  }));
}

void bind_tool(py::module_& module) {
  py::class_<PyTool>(module, "Tool",
                     "A tool that a script leads. Grasp, Cautery, Scalpel, Probe, ClipApplier and Needle say "
                     "more of their kinds.")
      .def("move_to", &lead, py::arg("position"), py::arg("orientation") = py::none(),
           "Moves it to this position by the end of the next frame [m]. The orientation is a unit quaternion "
           "(x, y, z, w).")
      .def("switch", &turn_on, py::arg("on"), "Switches it on or off. A grasp has nothing to switch.")
      .def("release", &let_go, "Takes it away.")
      .def_property_readonly("name", &name_of, "The name that it was given.")
      .def("__repr__",
           [](const PyTool& self) { return describe_tool(self, "Tool", "it is on", "it is off"); });
}

void bind_grasp(py::module_& module) {
  py::class_<PyGrasp, PyTool>(module, "Grasp", "A tool that holds vertices. World.grasp() makes it.")
      .def("move_to", &lead, py::arg("position"), py::arg("orientation") = py::none(),
           "Moves its centre to this position by the end of the next frame [m]. The orientation is a unit "
           "quaternion\n(x, y, z, w): how it has turned since it took hold.")
      .def("release", &let_go, "Lets go at the start of the next frame.")
      .def_property_readonly("vertices", &held_vertices, "(k,) int32, the vertices that it holds; a copy.")
      .def_property_readonly("position", &position_of,
                             "The position of its centre [m]. It is known after the first frame.")
      .def_property_readonly(
          "force",
          [](const PyGrasp& self) {
            return copied(use_grasp(self, [](AnyWorld&, const Grasp& grasp) { return grasp.force; }));
          },
          "The force that it exerts on the body, mean over the last frame [N].")
      .def_property_readonly(
          "torque",
          [](const PyGrasp& self) {
            return copied(use_grasp(self, [](AnyWorld&, const Grasp& grasp) { return grasp.torque; }));
          },
          "The torque that it exerts on the body about its centre, mean over the last frame [N m].")
      .def("__repr__", [](const PyGrasp& self) {
        return describe_tool(self, "Grasp", "it holds on", "it takes hold in the next frame");
      });
}

void bind_cautery(py::module_& module) {
  py::class_<PyCautery, PyTool>(
      module, "Cautery",
      "A tool that burns what its spherical tip or its hook touches, while it is on. "
      "World.cautery() makes it.")
      .def("move_to", &lead, py::arg("position"), py::arg("orientation") = py::none(),
           "Moves its tip to this position by the end of the next frame [m]. The orientation is a unit "
           "quaternion\n(x, y, z, w): how its hook has turned since it was brought.")
      .def("switch", &turn_on, py::arg("on"), "Switches it on or off.")
      .def("__repr__",
           [](const PyCautery& self) { return describe_tool(self, "Cautery", "it is on", "it is off"); });
}

void bind_scalpel(py::module_& module) {
  py::class_<PyScalpel, PyTool>(
      module, "Scalpel",
      "A tool that cuts with an edge from its tip to its heel, while it is on. World.scalpel() makes it.")
      .def("move_to", &lead, py::arg("position"), py::arg("orientation") = py::none(),
           "Moves its tip to this position by the end of the next frame [m]. The orientation is a unit "
           "quaternion\n(x, y, z, w): how the edge has turned since it was brought.")
      .def("switch", &turn_on, py::arg("on"), "Switches it on or off. It cuts while it is on.")
      .def("__repr__",
           [](const PyScalpel& self) { return describe_tool(self, "Scalpel", "it is on", "it is off"); });
}

void bind_clip_applier(py::module_& module) {
  py::class_<PyClipApplier, PyTool>(
      module, "ClipApplier",
      "A tool that closes a clip on what lies between its jaws. World.bring() makes it.")
      .def("move_to", &lead, py::arg("position"), py::arg("orientation") = py::none(),
           "Moves the middle of its jaws to this position by the end of the next frame [m]. The orientation "
           "is a unit\nquaternion (x, y, z, w): of the axes along the jaws, along the duct and from jaw to "
           "jaw.")
      .def("switch", &turn_on, py::arg("on"),
           "On: closes a clip where it is when the next frame begins. Off: opens its jaws again; the clip "
           "stays.")
      .def("release", &let_go, "Takes it away. Its clips stay.")
      .def("__repr__", [](const PyClipApplier& self) {
        return describe_tool(self, "ClipApplier", "its jaws are closed", "its jaws are open");
      });
}

// Returns value(probe) of the probe of a handle.
template <class Value>
auto read_probe(const PyProbe& self, Value&& value) {
  return use(self, [&](AnyWorld& world) {
    for (const Probe& probe : world.tools().lists().probes)
      if (probe.id == self.id && !probe.has_gone()) return value(probe);
    throw InputError("tool", "was let go already");
  });
}

void bind_probe(py::module_& module) {
  py::class_<PyProbe, PyTool>(
      module, "Probe",
      "A rigid body that touches the organ, or jaws that close on it. World.bring() makes it.")
      .def("move_to", &lead, py::arg("position"), py::arg("orientation") = py::none(),
           "Moves its origin to this position by the end of the next frame [m]. The orientation is a unit "
           "quaternion\n(x, y, z, w) of its axes.")
      .def("switch", &turn_on, py::arg("on"), "Closes jaws, or opens them. Others have nothing to switch.")
      .def_property_readonly(
          "force",
          [](const PyProbe& self) {
            return copied(read_probe(self, [](const Probe& p) { return p.force; }));
          },
          "The force that it exerts on the body, mean over the last frame [N].")
      .def_property_readonly(
          "torque",
          [](const PyProbe& self) {
            return copied(read_probe(self, [](const Probe& p) { return p.torque; }));
          },
          "The torque that it exerts on the body about its origin, mean over the last frame [N m].")
      .def_property_readonly(
          "grip", [](const PyProbe& self) { return read_probe(self, [](const Probe& p) { return p.grip; }); },
          "The force by which jaws press on what is between them, mean over the last frame [N].")
      .def("__repr__",
           [](const PyProbe& self) { return describe_tool(self, "Probe", "its jaws close", "it is there"); });
}

// Returns value(tool, figures) of the needle of a handle. Before its first frame the figures say nothing.
template <class Value>
auto read_needle(const PyNeedle& self, Value&& value) {
  return use(self, [&](AnyWorld& world) {
    for (const Needle& needle : world.tools().lists().needles) {
      if (needle.id != self.id || needle.has_gone()) continue;
      for (const NeedleFigures& figures : world.needles())
        if (figures.tool == self.id) return value(needle, figures);
      return value(needle, NeedleFigures{});
    }
    throw InputError("tool", "was let go already");
  });
}

const char* name_of_tip(NeedlePassage::Tip tip) {
  constexpr const char* names[] = {"free", "pushing", "inside", "leaving"};
  return names[int(tip)];
}

void bind_needle(py::module_& module) {
  py::class_<PyNeedle, PyTool>(module, "Needle",
                               "A curved needle that sews, with its thread. World.bring() makes it.")
      .def(
          "move_to", &lead, py::arg("position"), py::arg("orientation") = py::none(),
          "Moves the centre of its circle to this position by the end of the next frame [m]. The orientation "
          "is a unit\nquaternion (x, y, z, w) of its axes: turned about its z axis it goes along itself.")
      .def("release", &let_go, "Takes it away. Its thread stays in the tissue.")
      .def_property_readonly(
          "force",
          [](const PyNeedle& self) {
            return copied(read_needle(self, [](const Needle& n, const NeedleFigures&) { return n.force; }));
          },
          "The force that it exerts on the body, mean over the last frame [N].")
      .def_property_readonly(
          "torque",
          [](const PyNeedle& self) {
            return copied(read_needle(self, [](const Needle& n, const NeedleFigures&) { return n.torque; }));
          },
          "The torque that it exerts on the body about its centre, mean over the last frame [N m].")
      .def_property_readonly(
          "tip",
          [](const PyNeedle& self) {
            return name_of_tip(
                read_needle(self, [](const Needle&, const NeedleFigures& now) { return now.tip; }));
          },
          "Where its tip is: \"free\"; \"pushing\" on the surface; \"inside\"; \"leaving\", on the surface "
          "from "
          "inside.")
      .def_property_readonly(
          "inside",
          [](const PyNeedle& self) {
            return read_needle(self, [](const Needle&, const NeedleFigures& now) { return now.inside; });
          },
          "The length of it that is in tissue [m].")
      .def_property_readonly(
          "thread",
          [](const PyNeedle& self) {
            return read_needle(self, [](const Needle& n, const NeedleFigures&) { return n.thread; });
          },
          "The number of its thread, as in World.threads; None: it has none.")
      .def_property_readonly(
          "free_length",
          [](const PyNeedle& self) {
            return use(self, [&](AnyWorld& world) { return world.free_length(self.id); });
          },
          "How much of its thread hangs out before the first bite [m]; None: the thread is in no tissue.")
      .def("__repr__",
           [](const PyNeedle& self) { return describe_tool(self, "Needle", "it is there", "it is there"); });
}

}  // namespace

py::list handles_of(const std::shared_ptr<PyWorld>& world) {
  std::vector<AnyTool> handles;
  world->use([&](AnyWorld& any) {
    for (const ToolId id : any.tools().held_by_hands()) handles.push_back(handle_of(world, any, id));
  });
  return py::cast(std::move(handles));
}

void bind_tools(py::module_& module) {
  bind_tool(module);
  bind_grasp(module);
  bind_cautery(module);
  bind_scalpel(module);
  bind_probe(module);
  bind_clip_applier(module);
  bind_needle(module);
}

}  // namespace lobe::python
