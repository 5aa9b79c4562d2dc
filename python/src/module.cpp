// The module lobe._lobe, of which lobe/__init__.py is the front.
#include <pybind11/pybind11.h>

#include "lobe/error.h"
#include "scene.h"

namespace lobe::python {
namespace {

// lobe.InputError, a ValueError: `place` of the first fault, and all of them as pairs (place, message).
void bind_errors(py::module_& module) {
  static const py::handle type = [&] {
    py::object made = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
        "lobe.InputError",
        "Bad input. place: where the first fault is; faults: all of them, (place, message) each.",
        PyExc_ValueError, nullptr));
    made.attr("place") = "";
    made.attr("faults") = py::tuple();
    module.add_object("InputError", made);
    return made.release();
  }();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      py::list faults;
      for (const Fault& fault : error.faults()) faults.append(py::make_tuple(fault.place, fault.message));
      py::object raised = type(error.what());
      raised.attr("place") = error.faults().empty() ? "" : error.faults().front().place;
      raised.attr("faults") = faults;
      PyErr_SetObject(type.ptr(), raised.ptr());
    }
  });
}

}  // namespace

PYBIND11_MODULE(_lobe, module) {
  module.doc() = "Organ mechanics in real time (docs/python.md).";
  module.attr("__version__") = LOBE_VERSION;
  bind_errors(module);
  bind_mesh(module);
  bind_scene(module);
  bind_snapshot(module);
  bind_report(module);
  bind_checkpoint(module);
  bind_tools(module);
  bind_world(module);
  bind_solve(module);
}

}  // namespace lobe::python
