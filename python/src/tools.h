// Handles of tools that a script leads.
#pragma once

#include <variant>

#include "world.h"

namespace lobe::python {

// A handle is of the world as it is until the next restore().
struct PyTool {
  std::shared_ptr<PyWorld> world;
  ToolId id;
  int times_restored;  // when the handle was made
};
struct PyGrasp : PyTool {};
struct PyCautery : PyTool {};
struct PyScalpel : PyTool {};
struct PyProbe : PyTool {};
struct PyClipApplier : PyTool {};

// Brings a tool of the command, and returns its handle.
template <class Handle, class Bring>
Handle bring(const std::shared_ptr<PyWorld>& world, const Bring& command) {
  return world->use([&](AnyWorld& any) {
    const ToolId id = any.bring(command);
    return Handle{{world, id, world->times_restored()}};
  });
}

using AnyTool = std::variant<PyGrasp, PyCautery, PyScalpel, PyProbe, PyClipApplier>;

// Those of all tools that are led by hand and have not been let go.
py::list handles_of(const std::shared_ptr<PyWorld>& world);

}  // namespace lobe::python
