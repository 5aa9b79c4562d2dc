// A moment of a simulation that nothing changes any more.
#pragma once

#include <memory>
#include <variant>

#include "arrays.h"
#include "lobe/snapshot/snapshot.h"

namespace lobe::python {

struct PySnapshot {
  std::variant<std::shared_ptr<const Snapshot<float>>, std::shared_ptr<const Snapshot<double>>> of;
};

struct PySurface {  // of a snapshot
  std::shared_ptr<const PySnapshot> snapshot;
};

}  // namespace lobe::python
