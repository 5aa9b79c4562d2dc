// Finds pieces of the body that could move as a rigid body, over all ranks.
#pragma once

#include "lobe/fem/elements.h"
#include "lobe_petsc/ghosted.h"

namespace lobe::petsc {

using PrescribedComponents =
    Eigen::Matrix<bool, 3, Eigen::Dynamic>;  // whether each component of each local vertex is prescribed

// Throws InputError on all ranks if there is such a piece (solve/floating.h says when).
void refuse_floating_pieces(const Ranks& ranks, const Part& part, const Elements& elements,
                            const PrescribedComponents& is_prescribed);

}  // namespace lobe::petsc
