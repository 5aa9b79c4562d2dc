// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#pragma once

#include <stdexcept>

#include "lobe/error.h"

namespace lobe::meshing {

// A mesher or a repair step gave up on input that passed every check: time, memory, or a fault of its own.
// Bad input is lobe::InputError.
class MeshingFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lobe::meshing
