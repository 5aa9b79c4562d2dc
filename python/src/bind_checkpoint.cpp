#include <pybind11/stl/filesystem.h>

#include "checkpoint.h"
#include "lobe/file/scanner.h"
#include "lobe/text.h"
#include "scene.h"

namespace lobe::python {
namespace {

std::string describe_checkpoint(const PyCheckpoint& self) {
  const double time = std::visit([](const auto& checkpoint) { return checkpoint.state.time; }, self.of);
  const bool in_double = std::holds_alternative<Checkpoint<double>>(self.of);
  return "<lobe.Checkpoint: " + rounded(time) + " s, " + (in_double ? "double" : "single") + " precision>";
}

void save_checkpoint(const PyCheckpoint& self, const std::filesystem::path& file) {
  const py::gil_scoped_release others_run;
  std::visit([&](const auto& checkpoint) { write_checkpoint(file, checkpoint); }, self.of);
}

PyCheckpoint load_checkpoint(const std::filesystem::path& file) {
  const py::gil_scoped_release others_run;
  return {parse_any_checkpoint(file.string(), io::read_file(file))};
}

py::tuple checkpoint_state(const PyCheckpoint& self) {
  return py::make_tuple(
      py::bytes(std::visit([](const auto& checkpoint) { return checkpoint_bytes(checkpoint); }, self.of)));
}
PyCheckpoint checkpoint_of_state(const py::tuple& state) {
  return {parse_any_checkpoint("checkpoint", state[0].cast<std::string>())};
}

}  // namespace

void bind_checkpoint(py::module_& module) {
  py::class_<PyCheckpoint> checkpoint(
      module, "Checkpoint",
      "All that has changed in a world since it was built. It does not change. World.save() makes it.");
  checkpoint
      .def("save", &save_checkpoint, py::arg("file"),
           "Writes it as a file, for read_checkpoint(). Raises InputError where that is impossible.")
      .def(py::pickle(&checkpoint_state, &checkpoint_of_state))
      .def("__repr__", &describe_checkpoint);
  add_copies(checkpoint);
  module.def(
      "read_checkpoint", &load_checkpoint, py::arg("file"),
      "Reads a file of Checkpoint.save(). World.restore() goes on from it, in any process, to the same "
      "bits.\nRaises InputError for a file that is damaged, cut off or of another version.");
}

}  // namespace lobe::python
