#include <pybind11/stl.h>

#include "lobe/diagnostics/compare.h"
#include "lobe/error.h"
#include "lobe/solve/static_solver.h"
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

void bind_results(py::module_& module) {
  py::class_<StaticResult, std::shared_ptr<StaticResult>>(module, "StaticResult",
                                                          "Equilibrium, or as far as it was found.")
      .def_readonly("converged", &StaticResult::converged)
      .def_readonly("reason", &StaticResult::reason, "Why it did not converge, with the remedy.")
      .def_readonly("load_fraction", &StaticResult::load_fraction, "1: all of the loads")
      .def_readonly("residual", &StaticResult::residual, "relative, at that fraction")
      .def_readonly("energy", &StaticResult::energy, "elastic [J]")
      .def_readonly("iterations", &StaticResult::iterations)
      .def_property_readonly(
          "u", [](py::object self) { return read_only(self.cast<StaticResult&>().u, self); },
          "(n, 3) float64 displacements [m], read-only");
  py::class_<Difference>(module, "Difference", "How far a is from b.")
      .def_readonly("l2", &Difference::l2, "‖a − b‖ / ‖b‖ in L2 over the rest volume")
      .def_readonly("h1", &Difference::h1, "the same of the gradients")
      .def_readonly("max", &Difference::max, "largest distance of a vertex [m]")
      .def_readonly("relative_max", &Difference::relative_max, "to the largest displacement of b")
      .def_readonly("worst_vertex", &Difference::worst_vertex);
  py::class_<GestureOutcome>(module, "GestureOutcome")
      .def_readonly("name", &GestureOutcome::name)
      .def_readonly("reached", &GestureOutcome::reached, "share of the gesture that was in equilibrium")
      .def_readonly("predicted", &GestureOutcome::predicted, "relative L2 error")
      .def_readonly("measured", &GestureOutcome::measured, "relative L2 error");
  py::class_<Proposal, std::shared_ptr<Proposal>>(module, "Proposal", "Regions that lobe has chosen.")
      .def_property_readonly(
          "regions",
          [](py::object self) {
            const auto& models = self.cast<Proposal&>().region_of;
            return read_only(reinterpret_cast<const std::uint8_t*>(models.data()),
                             {py::ssize_t(models.size())}, self);
          },
          "(m,) uint8, for Scene(…, regions=…), read-only")
      .def_readonly("linear_share", &Proposal::linear_share, "of the volume")
      .def_readonly("predicted_speedup", &Proposal::predicted_speedup)
      .def_readonly("measured_speedup", &Proposal::measured_speedup, "of a step, against all non-linear")
      .def_readonly("gestures", &Proposal::gestures)
      .def_readonly("notes", &Proposal::notes);
}

}  // namespace

void bind_solve(py::module_& module) {
  bind_results(module);
  module.def("solve", &solve, py::arg("scene"), py::arg("tolerance") = 1e-10,
             "Static equilibrium under the scene's loads; tools are ignored. tolerance: of the residual, "
             "relative to the\n"
             "loads and reactions.");
  module.def("compare", &compare, py::arg("mesh"), py::arg("a"), py::arg("b"),
             "Of two displacement fields (n, 3) [m] on one mesh; b is the reference.");
  module.def("propose_regions", &proposal, py::arg("scene"), py::arg("tolerance") = 0.02, py::kw_only(),
             py::arg("precomputed") = true, py::arg("tensor_mass") = true, py::arg("gestures") = py::list(),
             "Chooses linear regions that keep the displacement within the tolerance (relative, L2) of the "
             "non-linear body\n"
             "for each gesture: dictionaries of name, vertices (indices or mask), and displacement [m] or "
             "force in all [N].\n"
             "None: those of the scene, else pulls at five places. Takes seconds to minutes.");
}

}  // namespace lobe::python
