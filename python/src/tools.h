// Handles of tools that a script leads.
#pragma once

#include <utility>
#include <variant>

#include "world.h"

namespace lobe::python {

// A handle is of the world as it is until the next restore().
struct PyTool {
  std::shared_ptr<PyWorld> world;
  ToolId id = 0;
  int times_restored = 0;  // when the handle was made
};
struct PyGrasp : PyTool {};
struct PyCautery : PyTool {};
struct PyScalpel : PyTool {};
struct PyProbe : PyTool {};
struct PyClipApplier : PyTool {};
struct PyNeedle : PyTool {};

// The handle of a kind of tool: PyTool where Python has no class of its own for it.
template <class Kind>
struct HandleOf {
  using Type = PyTool;
};
template <>
struct HandleOf<Grasp> {
  using Type = PyGrasp;
};
template <>
struct HandleOf<Cautery> {
  using Type = PyCautery;
};
template <>
struct HandleOf<Scalpel> {
  using Type = PyScalpel;
};
template <>
struct HandleOf<Probe> {
  using Type = PyProbe;
};
template <>
struct HandleOf<ClipApplier> {
  using Type = PyClipApplier;
};
template <>
struct HandleOf<Needle> {
  using Type = PyNeedle;
};
using AnyTool = std::variant<PyTool, PyGrasp, PyCautery, PyScalpel, PyProbe, PyClipApplier, PyNeedle>;

// The handle of the tool of this id.
inline AnyTool handle_of(const std::shared_ptr<PyWorld>& world, AnyWorld& any, ToolId id) {
  AnyTool handle;
  any.tools().visit(id, [&]<class Kind>(const Kind&) {
    typename HandleOf<Kind>::Type made;
    static_cast<PyTool&>(made) = {world, id, world->times_restored()};
    handle = std::move(made);
  });
  return handle;
}

// Brings a tool of the command, and returns its handle.
template <class Bring>
AnyTool bring(const std::shared_ptr<PyWorld>& world, const Bring& command) {
  return world->use([&](AnyWorld& any) { return handle_of(world, any, any.bring(command)); });
}

// Those of all tools that are led by hand and have not been let go.
py::list handles_of(const std::shared_ptr<PyWorld>& world);

}  // namespace lobe::python
