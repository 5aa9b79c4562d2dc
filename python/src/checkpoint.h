// A checkpoint in Python, of either precision.
#pragma once

#include "arrays.h"
#include "lobe/sim/checkpoint.h"

namespace lobe::python {

struct PyCheckpoint {
  AnyCheckpoint of;
};

}  // namespace lobe::python
