#include <pybind11/stl.h>

#include "arrays.h"
#include "lobe/organ/report.h"
#include "lobe/text.h"
#include "scene.h"

namespace lobe::python {
namespace {

std::string describe_report(const Report& report) {
  std::string text = std::string("<lobe.Report: ") + (report.ok ? "ok" : "failed") + ", " +
                     std::to_string(report.steps) + " steps";
  if (!report.conditions.empty()) text += ", " + std::to_string(report.conditions.size()) + " conditions";
  return text + ">";
}

void bind_condition(py::module_& module) {
  py::class_<Condition>(module, "Condition", "Something unusual that happened in a frame, with a remedy.")
      .def_property_readonly(
          "kind", [](const Condition& c) { return name(c.kind); }, "Its kind, such as \"sub_stepped\".")
      .def_readonly("text", &Condition::text, "One line: the place, figures, a remedy.")
      .def_readonly("time", &Condition::time, "The simulated time at which it happened [s].")
      .def("__repr__", [](const Condition& c) {
        return "<lobe.Condition: " + std::string(name(c.kind)) + ": " + c.text + ">";
      });
}

void bind_event(py::module_& module) {
  py::class_<Event>(module, "Event",
                    "What tore, broke, burnt, was clipped or pierced, bleeds or leaks in a frame, and where.")
      .def_property_readonly(
          "kind", [](const Event& e) { return name(e.kind); },
          "\"torn\", \"broken\", \"burnt\", \"clipped\", \"bleeding\", \"leak\", \"punctured\", \"exited\" "
          "or "
          "\"drawn_out\".")
      .def_readonly("time", &Event::time, "The simulated time at which it happened [s].")
      .def_property_readonly(
          "place",
          [](const Event& e) -> py::object { return e.place ? py::object(copied(*e.place)) : py::none(); },
          "Where it happened, (3,) [m]; None if that is not known.")
      .def_readonly(
          "size", &Event::size,
          "Of torn: the area that came apart [m²]. Of broken: the tension of the thread [N]. Of "
          "burnt: the volume [m³].\nOf clipped: how far apart the legs found the tissue's faces [m]. Of "
          "bleeding and leak: the open\narea [m²]. Of punctured and exited: the needle's force along the "
          "normal "
          "[N]. 0: it has none.")
      .def_readonly("text", &Event::text, "One line for people; empty if it only goes on.")
      .def("__repr__", [](const Event& e) {
        return "<lobe.Event: " + std::string(name(e.kind)) + (e.text.empty() ? "" : ": " + e.text) + ">";
      });
}

void bind_transitions(py::module_& module) {
  py::class_<Transitions>(module, "Transitions",
                          "How often vertices of reduced regions were embedded or became full, and by what "
                          "that changed energies.")
      .def_readonly("count", &Transitions::count, "The number of transitions.")
      .def_readonly("kinetic", &Transitions::kinetic, "The change of the kinetic energy [J].")
      .def_readonly("elastic", &Transitions::elastic, "The change of the elastic energy [J].")
      .def_readonly("loads", &Transitions::loads, "The change of the potential energy of loads [J].")
      .def_property_readonly("total", &Transitions::total, "The change of the sum of these energies [J].")
      .def("__repr__", [](const Transitions& t) {
        return "<lobe.Transitions: " + std::to_string(t.count) + ", " + rounded(t.total()) + " J>";
      });
}

}  // namespace

void bind_report(py::module_& module) {
  bind_condition(module);
  bind_event(module);
  bind_transitions(module);
  py::class_<Report>(module, "Report", "What happened in one frame. World.advance() returns it.")
      .def_readonly("ok", &Report::ok,
                    "Whether the world was advanced. If it is False, the conditions say why it was not.")
      .def_readonly("steps", &Report::steps, "The number of steps that the frame took.")
      .def_readonly("time_step", &Report::time_step, "The smallest step that was taken [s].")
      .def_readonly("time_step_limit", &Report::time_step_limit,
                    "The longest stable step, found at the start of the frame or a little earlier [s].")
      .def_readonly("reruns", &Report::reruns, "How often the frame was run again with smaller steps.")
      .def_readonly("tets_removed", &Report::tets_removed, "The number of tetrahedra that were removed.")
      .def_readonly("tets_copied", &Report::tets_copied,
                    "The number of parts that scalpels have cut off tetrahedra. Each is a tetrahedron.")
      .def_readonly("cut_area", &Report::cut_area, "The area that scalpels have opened, at rest [m²].")
      .def_readonly("transitions", &Report::transitions, "Those of reduced regions since the last report.")
      .def_readonly("smallest_volume_ratio", &Report::smallest_volume_ratio,
                    "The least ratio of the present volume to that at rest, of non-linear tetrahedra and "
                    "lattice cells.")
      .def_readonly("conditions", &Report::conditions, "A list of Condition: what unusual things happened.")
      .def_readonly("events", &Report::events,
                    "A list of Event: what tore, broke, burnt, was clipped or pierced, bleeds or leaks, and "
                    "where.")
      .def("__repr__", &describe_report);
}

}  // namespace lobe::python
