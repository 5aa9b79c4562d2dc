// The forces with which boundary conditions hold a body that moves.
#pragma once

#include <vector>

#include "lobe/scene/resolve.h"
#include "lobe/sim/world.h"

namespace lobe {

// Returns the forces on the body by boundary conditions and grasps now: 3 × #vertices [N], 0 in components
// that nothing holds. Costs one evaluation of the forces.
template <class Real>
Mat3X<double> reactions_of(World<Real>& world);

// The sum over what each entry of the boundary holds [N]. `reactions`: 3 × #vertices [N]; copies that cuts
// made belong to the entry of the vertex that was split.
std::vector<Vec3d> held_forces(const std::vector<HeldEntry>& entries, const Elements& elements,
                               const Mat3X<double>& reactions);

}  // namespace lobe
