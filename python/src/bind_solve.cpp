#include <pybind11/stl.h>

#include "lobe/diagnostics/compare.h"
#include "lobe/error.h"
#include "lobe/solve/static_solver.h"
#include "lobe/text.h"
#include "scene.h"

namespace lobe::python {
namespace {

StaticResult solve(const PyScene& scene, double tolerance) {
  StaticOptions options;
  options.tolerance = tolerance;
  const Setup& setup = scene.resolved().setup;
  const py::gil_scoped_release others_run;
  return solve_static(setup, options);
}

Difference compare(const TetMesh& mesh, const py::object& a, const py::object& b) {
  const Mat3X<double> first = columns3(a, "a"), second = columns3(b, "b");
  return compare_displacements(mesh, first, second);
}

Proposal proposal(const PyScene& scene, double tolerance, bool precomputed, bool tensor_mass,
                  const py::list& gestures) {
  const Resolved& resolved = scene.resolved();
  ProposalOptions options;
  options.tolerance = tolerance;
  options.condense = precomputed;
  options.tensor_mass = tensor_mass;
  options.in_double = scene.scene().in_double();
  std::vector<Gesture> wanted;
  for (std::size_t i = 0; i < gestures.size(); ++i) {
    const std::string place = "gestures/" + std::to_string(i);
    if (!py::isinstance<py::dict>(gestures[i])) throw InputError(place, "must be a dictionary");
    const py::dict entry = gestures[i];
    for (const auto& [key, value] : entry)
      if (const auto name = py::str(key).cast<std::string>();
          name != "name" && name != "vertices" && name != "displacement" && name != "force")
        throw InputError(place, name + " is unknown: name, vertices, and displacement or force are known");
    if (!entry.contains("vertices") || entry.contains("displacement") == entry.contains("force"))
      throw InputError(place, "must have vertices, and either displacement or force");
    Gesture gesture;
    gesture.name = entry.contains("name") ? py::str(entry["name"]).cast<std::string>()
                                          : "gesture " + std::to_string(i + 1);
    gesture.vertices = indices(entry["vertices"], place + "/vertices", resolved.setup.mesh.vertex_count());
    if (entry.contains("force"))
      gesture.force = vector3(entry["force"], place + "/force");
    else
      gesture.displacements.assign(gesture.vertices.size(),
                                   vector3(entry["displacement"], place + "/displacement"));
    wanted.push_back(std::move(gesture));
  }
  if (wanted.empty()) wanted = resolved.gestures;
  const py::gil_scoped_release others_run;
  return propose_regions(resolved.setup, std::move(wanted), options);
}

void bind_static_result(py::module_& module) {
  py::class_<StaticResult, std::shared_ptr<StaticResult>>(
      module, "StaticResult", "An equilibrium, or how far it was found. solve() returns it.")
      .def_readonly("converged", &StaticResult::converged,
                    "Whether an equilibrium under all loads was found.")
      .def_readonly("reason", &StaticResult::reason, "Why it did not converge, with the remedy.")
      .def_readonly("load_fraction", &StaticResult::load_fraction,
                    "The fraction of the loads up to which it was found; 1: all of them.")
      .def_readonly("residual", &StaticResult::residual,
                    "The residual at that fraction, relative to loads and reactions.")
      .def_readonly("energy", &StaticResult::energy, "The elastic energy [J].")
      .def_readonly("iterations", &StaticResult::iterations, "The number of iterations of Newton's method.")
      .def_property_readonly(
          "u", [](py::object self) { return read_only(self.cast<StaticResult&>().u, self); },
          "(n, 3) float64, displacements of the vertices [m], read-only.")
      .def("__repr__", [](const StaticResult& self) {
        return std::string("<lobe.StaticResult: ") + (self.converged ? "converged" : "not converged") + ", " +
               std::to_string(self.iterations) + " iterations, residual " + rounded(self.residual) + ">";
      });
}

void bind_difference(py::module_& module) {
  py::class_<Difference>(module, "Difference", "How far the field a is from b. compare() returns it.")
      .def_readonly("l2", &Difference::l2, "‖a − b‖ / ‖b‖ in L2 over the rest volume.")
      .def_readonly("h1", &Difference::h1, "The same of the gradients.")
      .def_readonly("max", &Difference::max, "The largest distance of a vertex [m].")
      .def_readonly("relative_max", &Difference::relative_max,
                    "The largest distance of a vertex, relative to the largest displacement of b.")
      .def_readonly("worst_vertex", &Difference::worst_vertex, "The vertex with the largest distance.")
      .def("__repr__", [](const Difference& self) {
        return "<lobe.Difference: L2 " + rounded(self.l2) + ", H1 " + rounded(self.h1) + ", at most " +
               rounded(self.max) + " m>";
      });
}

void bind_proposal(py::module_& module) {
  py::class_<GestureOutcome>(module, "GestureOutcome", "What proposed regions get wrong in one gesture.")
      .def_readonly("name", &GestureOutcome::name, "The name of the gesture.")
      .def_readonly("reached", &GestureOutcome::reached,
                    "The share of the gesture at which the body was still in equilibrium.")
      .def_readonly("predicted", &GestureOutcome::predicted, "The predicted relative L2 error.")
      .def_readonly("measured", &GestureOutcome::measured, "The measured relative L2 error.")
      .def("__repr__", [](const GestureOutcome& self) {
        return "<lobe.GestureOutcome \"" + self.name + "\": measured " + rounded(self.measured) + ">";
      });
  py::class_<Proposal, std::shared_ptr<Proposal>>(
      module, "Proposal", "Regions that lobe has chosen. propose_regions() returns it.")
      .def_property_readonly(
          "regions",
          [](py::object self) {
            const auto& models = self.cast<Proposal&>().region_of;
            return read_only(reinterpret_cast<const std::uint8_t*>(models.data()),
                             {py::ssize_t(models.size())}, self);
          },
          "(m,) uint8, the code of each tetrahedron, for Scene(…, regions=…), read-only.")
      .def_readonly("linear_share", &Proposal::linear_share, "The share of the volume that is linear.")
      .def_readonly("predicted_speedup", &Proposal::predicted_speedup,
                    "The predicted speed of a step, relative to that of all non-linear.")
      .def_readonly("measured_speedup", &Proposal::measured_speedup,
                    "The measured speed of a step, relative to that of all non-linear.")
      .def_readonly("gestures", &Proposal::gestures, "A list with a GestureOutcome for each gesture.")
      .def_readonly("notes", &Proposal::notes, "A list of lines: what could not be had, and why.")
      .def("__repr__", [](const Proposal& self) {
        return "<lobe.Proposal: " + rounded(100 * self.linear_share) + " % of the volume linear, " +
               rounded(self.measured_speedup) + " times as fast>";
      });
}

}  // namespace

void bind_solve(py::module_& module) {
  bind_static_result(module);
  bind_difference(module);
  bind_proposal(module);
  module.def(
      "solve", &solve, py::arg("scene"), py::arg("tolerance") = 1e-10,
      "Finds the static equilibrium under the scene's loads; tools are ignored. tolerance: of the residual, "
      "relative to the\n"
      "loads and reactions.");
  module.def(
      "compare", &compare, py::arg("mesh"), py::arg("a"), py::arg("b"),
      "Compares two displacement fields (n, 3) [m] on one mesh; b is the reference. Returns a Difference.");
  module.def("propose_regions", &proposal, py::arg("scene"), py::arg("tolerance") = 0.02, py::kw_only(),
             py::arg("precomputed") = true, py::arg("tensor_mass") = true, py::arg("gestures") = py::list(),
             "Chooses linear regions that keep the displacement within the tolerance (relative, L2) of the "
             "non-linear body\n"
             "for each gesture: dictionaries of name, vertices (indices or mask), and displacement [m] or "
             "force in all [N].\n"
             "None: those of the scene, else pulls at five places. Takes seconds to minutes.");
}

}  // namespace lobe::python
