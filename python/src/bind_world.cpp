#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <limits>

#include "lobe/error.h"
#include "lobe/scene/parse_tool.h"
#include "lobe/text.h"
#include "tools.h"

namespace lobe::python {
namespace {

using WorldClass = py::class_<PyWorld, std::shared_ptr<PyWorld>>;

RegionModel model_of(const std::string& name) {
  for (std::size_t i = 0; i < region_model_names.size(); ++i)
    if (name == region_model_names[i]) return RegionModel(i);
  throw InputError("model", "\"" + name + "\", must be one of region_models");
}

std::vector<Index> vertices_of(PyWorld& world, const py::object& vertices) {
  return indices(vertices, "vertices", world.use([](AnyWorld& any) { return any.vertex_count(); }));
}
std::vector<Index> tets_of(PyWorld& world, const py::object& tets) {
  return indices(tets, "tets", world.use([](AnyWorld& any) { return any.tet_count(); }));
}

// ---- Tools

std::vector<Index> vertices_near(PyWorld& world, const Vec3d& centre, double radius) {
  return world.use([&](AnyWorld& any) {
    std::vector<Index> near;
    const Mat3X<double> x = any.positions();
    const Topology& topology = any.elements().topology;
    for (Index v = 0; v < x.cols(); ++v)
      if (!topology.around(v).empty() && (x.col(v) - centre).norm() <= radius) near.push_back(v);
    return near;
  });
}

AnyTool take(const std::shared_ptr<PyWorld>& world, const py::object& vertices, const py::object& near,
             double radius, const std::string& name) {
  if (vertices.is_none() == near.is_none())
    throw InputError("grasp", "wants either vertices, or near and radius");
  TakeHold command{name, {}};
  if (vertices.is_none()) {
    const Vec3d centre = vector3(near, "near");
    if (!(radius > 0)) throw InputError("radius", "must be above 0 m");
    command.vertices = vertices_near(*world, centre, radius);
    if (command.vertices.empty()) throw InputError("near", "no vertex lies within the radius");
  } else {
    command.vertices = vertices_of(*world, vertices);
  }
  return bring(world, command);
}

AnyTool bring_cautery(const std::shared_ptr<PyWorld>& world, const py::object& position, double radius,
                      const std::string& name) {
  return bring(world, BringCautery{name, radius, vector3(position, "position")});
}

AnyTool bring_any(const std::shared_ptr<PyWorld>& world, const py::dict& tool,
                  const std::filesystem::path& folder) {
  const auto text = py::module_::import("json").attr("dumps")(tool).cast<std::string>();
  return std::visit([&](const auto& command) { return bring(world, command); },
                    parse_tool(text, folder).command);
}

AnyTool bring_scalpel(const std::shared_ptr<PyWorld>& world, const py::object& tip, const py::object& heel,
                      double snap, bool along_faces, const std::string& name) {
  const BladePose pose{vector3(tip, "tip"), vector3(heel, "heel")};
  return bring(world, BringScalpel{name, pose, snap, along_faces});
}

void add_tools(WorldClass& world) {
  world
      .def("grasp", &take, py::arg("vertices") = py::none(), py::kw_only(), py::arg("near") = py::none(),
           py::arg("radius") = 0.0, py::arg("name") = "hand",
           "Takes hold, at the start of the next frame, of vertices (indices or a mask), or of all within "
           "the radius [m]\nof a point [m].")
      .def(
          "bring", &bring_any, py::arg("tool"), py::kw_only(), py::arg("folder") = ".",
          "Brings a tool that a dictionary describes as a scene does (docs/scene.md), with \"at\", a row of "
          "its path\nwithout the time, in place of \"path\": {\"type\": \"probe\", \"shape\": {\"sphere\": "
          "{\"radius\": 0.01}}, \"at\": [0.1, 0, 0.05]}.\nReturns its handle: Cautery, Scalpel, Probe, "
          "ClipApplier or Needle.\n"
          "folder: what relative paths of shapes are relative to.\nRaises ValueError with each fault and its "
          "JSON pointer.")
      .def("cautery", &bring_cautery, py::arg("position"), py::kw_only(), py::arg("radius"),
           py::arg("name") = "cautery", "Adds a cautery, switched off. The radius is its tip's [m].")
      .def("scalpel", &bring_scalpel, py::arg("tip"), py::arg("heel"), py::kw_only(), py::arg("snap") = 0.1,
           py::arg("along_faces") = false, py::arg("name") = "scalpel",
           "Adds a scalpel, which does not cut yet. Its edge leads from tip to heel [m]. A vertex nearer to "
           "the cut than\nthe share `snap` of its shortest edge lies on it. along_faces: it opens only faces "
           "that the mesh has.")
      .def_property_readonly("tools", &handles_of,
                             "A list of handles, as of bring() and grasp(): one for each tool that is led by "
                             "hand and was not let "
                             "go.\nrestore() makes all earlier handles invalid.");
}

// ---- Edits

void set_forces(PyWorld& world, const py::object& vertices, const py::object& forces) {
  const auto at = vertices_of(world, vertices);
  const Mat3X<double> f = columns3(forces, "forces");
  if (f.cols() != Index(at.size())) throw InputError("forces", "must be one per vertex");
  SetForces command;
  for (std::size_t i = 0; i < at.size(); ++i) command.forces.push_back({at[i], f.col(Eigen::Index(i))});
  world.apply(command);
}

void set_springs(PyWorld& world, const py::object& vertices, const py::object& points, double stiffness) {
  const auto at = vertices_of(world, vertices);
  const Mat3X<double> p = columns3(points, "points");
  if (p.cols() != Index(at.size())) throw InputError("points", "must be one per vertex");
  SetSprings command;
  for (std::size_t i = 0; i < at.size(); ++i)
    command.springs.push_back({at[i], stiffness, p.col(Eigen::Index(i))});
  world.apply(command);
}

void add_edits(WorldClass& world) {
  world
      .def(
          "remove_tets",
          [](PyWorld& self, const py::object& tets) { self.apply(RemoveTets{tets_of(self, tets)}); },
          py::arg("tets"), "Removes tetrahedra: indices or a mask.")
      .def(
          "set_region",
          [](PyWorld& self, const py::object& tets, const std::string& model) {
            self.apply(SetRegion{tets_of(self, tets), model_of(model)});
          },
          py::arg("tets"), py::arg("model"),
          "Gives tetrahedra (indices or a mask) to a region of this model, one of region_models.")
      .def("set_forces", &set_forces, py::arg("vertices"), py::arg("forces"),
           "Sets forces on vertices, (k, 3) [N], in place of those that were set before.")
      .def("set_springs", &set_springs, py::arg("vertices"), py::arg("points"), py::arg("stiffness"),
           "Sets springs from vertices to points (k, 3) [m], each of the stiffness [N/m], in place of those "
           "that were set\nbefore.")
      .def(
          "move_springs",
          [](PyWorld& self, const py::object& points) {
            self.apply(MoveSprings{columns3(points, "points")});
          },
          py::arg("points"), "Moves the points of the springs, (k, 3) [m], by the end of the next frame.");
}

// ---- Threads

int bring_thread(PyWorld& world, double stiffness, double friction, double strength, double holds) {
  const int thread = world.use([](AnyWorld& any) { return any.next_thread(); });
  world.apply(BringThread{thread, {stiffness, friction, strength, holds}});
  return thread;
}

void bite(PyWorld& world, int thread, const py::object& point) {
  const Vec3d x = vector3(point, "point");
  const FoundPoint found = world.use([&](AnyWorld& any) { return any.embed(x); });
  constexpr double rounding = 1e-6;  // [m]
  if (found.distance > rounding)
    throw InputError("point", "is " + rounded(found.distance) + " m outside of every tetrahedron");
  world.apply(Bite{thread, found.point});
}

void pull(PyWorld& world, int thread, const py::object& point) {
  if (point.is_none())
    world.apply(Pull{thread, false});
  else
    world.apply(Pull{thread, true, vector3(point, "point")});
}

py::list threads_of(PyWorld& world) {
  const std::vector<ThreadLine> lines = world.use([](AnyWorld& any) { return any.threads(); });
  py::list list;
  for (const ThreadLine& line : lines) {
    py::dict entry;
    entry["thread"] = line.thread;
    entry["name"] = line.name;
    entry["points"] = copied(line.points);
    entry["tensions"] = line.tensions;
    list.append(entry);
  }
  return list;
}

// ---- Attachments

// Pairs of points of the tissue as it is now, each a strand.
void attach(PyWorld& world, const std::string& name, const py::object& first, const py::object& second,
            double stiffness, double strength, double softening, double slack, bool to_world) {
  const Mat3X<double> from = columns3(first, "first"), to = columns3(second, "second");
  if (from.cols() != to.cols()) throw InputError("second", "must have as many points as first");
  if (!(stiffness > 0)) throw InputError("stiffness", "must be above 0 N/m");
  AttachmentSetup attachment;
  attachment.name = name;
  attachment.softening = softening;
  attachment.holds_until = strength / stiffness;
  const auto find = [&](const Vec3d& x, const char* which) {
    const FoundPoint found = world.use([&](AnyWorld& any) { return any.embed(x); });
    constexpr double rounding = 1e-6;  // [m]
    if (found.distance > rounding)
      throw InputError(which, "is " + rounded(found.distance) + " m outside of every tetrahedron");
    return found.point;
  };
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    StrandSetup& strand = attachment.strands.emplace_back();
    strand.from = find(from.col(i), "first");
    if (to_world)
      strand.anchor = to.col(i);
    else
      strand.to = find(to.col(i), "second");
    strand.length = (to.col(i) - from.col(i)).norm() + slack;
    strand.stiffness = stiffness;
  }
  world.apply(Attach{attachment});
}

py::list attachments_of(PyWorld& world) {
  const auto [figures, lines] =
      world.use([](AnyWorld& any) { return std::pair(any.attachments(), any.lines()); });
  py::list list;
  for (const AttachmentFigures& of : figures) {
    py::dict entry;
    entry["name"] = of.name;
    entry["strands"] = of.strands;
    entry["area"] = of.area;
    entry["tension"] = of.tension;
    entry["stored"] = of.stored;
    entry["released"] = of.released;
    entry["torn"] = of.torn.count;
    entry["torn_area"] = of.torn.area;
    entry["cut"] = of.cut.count;
    entry["ends"] = copied(Mat3X<double>(3, 0));
    entry["tensions"] = std::vector<double>();
    for (const TermLines& line : lines)
      if (line.term == Attachments<double>::term_name && line.name == of.name) {
        entry["ends"] = copied(line.ends);
        entry["tensions"] = line.tensions;
      }
    list.append(entry);
  }
  return list;
}

// ---- Clips, and bodies that carry blood or bile

py::list clips_of(PyWorld& world) {
  py::list list;
  for (const ClipFigures& of : world.use([](AnyWorld& any) { return any.clips(); })) {
    py::dict entry;
    entry["name"] = of.name;
    entry["pairs"] = of.pairs;
    entry["apart"] = of.apart;
    entry["force"] = of.force;
    list.append(entry);
  }
  return list;
}

py::list carriers_of(PyWorld& world) {
  py::list list;
  world.use([&](AnyWorld& any) {
    for (const CarrierFigures& of : any.carriers()) {
      py::dict entry;
      entry["body"] = any.elements().bodies.names[std::size_t(of.body)];
      entry["carries"] = carries_names[std::size_t(of.carries)];
      entry["open"] = of.open;
      list.append(entry);
    }
  });
  return list;
}

void add_clips(WorldClass& world) {
  world
      .def_property_readonly("clips", &clips_of,
                             "The clips that were closed, a list of dictionaries: `name`, `pairs` of points "
                             "that it holds (0: it has\nfallen off), how far they are `apart` at most [m], "
                             "and its `force` [N].")
      .def_property_readonly("carriers", &carriers_of,
                             "The bodies that carry blood or bile, a list of dictionaries: `body`, what it "
                             "`carries`, and the area [m²] of\nits faces that are `open` and fed, as the "
                             "last frame began.");
}

void add_attachments(WorldClass& world) {
  world
      .def("attach", &attach, py::arg("name"), py::arg("first"), py::arg("second"), py::kw_only(),
           py::arg("stiffness"), py::arg("strength") = std::numeric_limits<double>::infinity(),
           py::arg("softening") = 3.0, py::arg("slack") = 0.0, py::arg("to_world") = false,
           "Ties points of the tissue as it is now to others, (k, 3) [m], or to points that do not move "
           "(to_world).\nstiffness: of each strand [N/m]; strength: its largest force [N]; softening: the "
           "elongation at which it\nhas torn over that at which its force begins to fall; slack [m].")
      .def(
          "detach", [](PyWorld& self, const std::string& name) { self.apply(Detach{name}); }, py::arg("name"),
          "Cuts all strands of an attachment.")
      .def_property_readonly(
          "attachments", &attachments_of,
          "The attachments, a list of dictionaries: `name`, `strands` that are left, their `area` [m²], "
          "largest `tension`\n[N] and `stored` energy [J], the energy `released` by tearing [J], the numbers "
          "`torn` and `cut` of strands that\nhave gone, `torn_area` [m²], `ends` (2 k, 3) of the strands, "
          "one "
          "after the other [m], and their `tensions` [N].");
}

void add_threads(WorldClass& world) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  world
      .def("thread", &bring_thread, py::kw_only(), py::arg("stiffness") = 98.0, py::arg("friction") = 0.2,
           py::arg("strength") = unlimited, py::arg("holds") = unlimited,
           "Brings a thread and returns its number. stiffness: EA [N]; friction: of the capstan law; "
           "strength: "
           "tension\nabove which it breaks [N]; holds: force that tissue bears at a bite [N].")
      .def("bite", &bite, py::arg("thread"), py::arg("point"),
           "Draws a thread through the tissue at a present point [m], after its earlier bites.")
      .def("pull", &pull, py::arg("thread"), py::arg("point"),
           "Takes the free ends of a thread to a point [m]; later calls move them there by the end of the "
           "next "
           "frame.\nNone: lets go.")
      .def(
          "tie",
          [](PyWorld& self, int thread, Index first, Index last, double tighten, double over) {
            self.apply(Tie{thread, first, last, tighten, over});
          },
          py::arg("thread"), py::arg("first") = 0, py::arg("last") = 1, py::kw_only(),
          py::arg("tighten") = 0.0, py::arg("over") = 0.2,
          "Closes a thread between two of its bites to a loop, and draws it together by `tighten` [m] in the "
          "time\n`over` [s].")
      .def(
          "cut_thread",
          [](PyWorld& self, int thread, Index after) {
            self.apply(CutThread{thread, after});
          },
          py::arg("thread"), py::arg("after") = 0, "Cuts a thread after one of its bites.")
      .def_property_readonly("threads", &threads_of,
                             "The threads that are sewn, a list of dictionaries: number `thread`, `name`, "
                             "`points` (k, 3) [m] and "
                             "the\n`tensions` between them [N].");
}

// ---- The world itself

py::dict energies_of(PyWorld& world) {
  const Energies e = world.use([](AnyWorld& any) { return any.energies(); });
  py::dict result;
  result["kinetic"] = e.kinetic;
  result["elastic_linear"] = e.elastic_linear;
  result["elastic_nonlinear"] = e.elastic_nonlinear;
  result["loads"] = e.loads;
  result["applied"] = e.applied;
  result["total"] = e.total();
  return result;
}

std::string describe_world(PyWorld& world) {
  std::string text = "another thread is using it";
  try {
    text = world.use([](AnyWorld& any) {
      return rounded(any.time()) + " s, " + std::to_string(any.elements().topology.alive_count()) +
             " tetrahedra";
    });
  } catch (const std::runtime_error&) {
  }
  return "<lobe.World: " + text + ", " + (world.in_double ? "double" : "single") + " precision>";
}

py::list bodies_of(PyWorld& world) {
  py::list bodies;
  for (const BodyFigures& body : world.use([](AnyWorld& any) { return any.bodies(); })) {
    py::dict entry;
    entry["name"] = body.name;
    entry["tetrahedra"] = body.tets;
    entry["mass"] = body.mass;
    entry["volume"] = body.volume;
    entry["kinetic"] = body.kinetic;
    entry["elastic"] = body.elastic;
    entry["centre"] = copied(body.centre);
    entry["momentum"] = copied(body.momentum);
    bodies.append(entry);
  }
  return bodies;
}

void add_state(WorldClass& world) {
  world
      .def_property_readonly(
          "time", [](PyWorld& self) { return self.use([](AnyWorld& any) { return any.time(); }); },
          "The time that was simulated [s].")
      .def_property_readonly(
          "scene", [](const PyWorld& self) { return self.scene; }, "The Scene that it was built from.")
      .def_property_readonly(
          "precision", [](const PyWorld& self) { return self.in_double ? "double" : "single"; },
          "The precision of its numbers: \"single\" or \"double\".")
      .def_property_readonly(
          "tet_count",
          [](PyWorld& self) {
            return self.use([](AnyWorld& any) { return any.elements().topology.alive_count(); });
          },
          "The number of tetrahedra that are left.")
      .def_property_readonly(
          "vertex_count",
          [](PyWorld& self) { return self.use([](AnyWorld& any) { return any.vertex_count(); }); },
          "The number of vertices, with those that cuts have made.")
      .def(
          "snapshot", [](PyWorld& self) { return self.use([](AnyWorld& any) { return any.snapshot(); }); },
          "Returns a copy of the present state, which does not change.")
      .def(
          "forces",
          [](PyWorld& self) { return copied(self.use([](AnyWorld& any) { return any.forces(); })); },
          "Returns the internal and external forces on vertices at the present state, (n, 3) [N]; a copy.")
      .def_property_readonly(
          "bodies", &bodies_of,
          "A list with a dictionary for each body of a scene that has \"bodies\", in their order: name, "
          "tetrahedra that are\nleft, mass [kg], volume [m³], kinetic and elastic energy [J], centre of mass "
          "(3,) [m], momentum (3,) [kg m/s].")
      .def("energies", &energies_of, "Returns a dictionary of energies [J].")
      .def(
          "time_step_limit",
          [](PyWorld& self) { return self.use([](AnyWorld& any) { return any.time_step_limit(); }); },
          "Returns the stable step 2/ω_max at the present state [s].")
      .def("__repr__", &describe_world);
}

}  // namespace

void bind_world(py::module_& module) {
  WorldClass world(module, "World",
                   "A body that is simulated. A call or a look by a second thread at the same time raises "
                   "RuntimeError; the "
                   "GIL is\nreleased meanwhile.");
  world
      .def(py::init(&make_world), py::arg("scene"), py::kw_only(), py::arg("threads") = 1,
           py::arg("precision") = py::none(),
           "Builds a world of a Scene. precision: \"single\" or \"double\", in place of the scene's. Raises "
           "InputError.")
      .def(
          "advance",
          [](PyWorld& self, double duration) {
            return self.use([&](AnyWorld& any) { return any.advance(duration); });
          },
          py::arg("duration"),
          "Simulates one frame [s]. Does not raise for what happens in it: look at the report.")
      .def(
          "save", [](PyWorld& self) { return self.use([](AnyWorld& any) { return any.save(); }); },
          "Returns a Checkpoint of the present state.")
      .def("restore", &PyWorld::restore, py::arg("checkpoint"),
           "Goes back to a Checkpoint of this scene, and from there on with the same bits. Handles of tools "
           "of "
           "before are\ninvalid afterwards; `tools` has new ones. Raises InputError for a checkpoint of "
           "another scene or precision, and changes\nnothing then.");
  add_state(world);
  add_tools(world);
  add_edits(world);
  add_threads(world);
  add_attachments(world);
  add_clips(world);
}

}  // namespace lobe::python
