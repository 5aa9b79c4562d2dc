// Where a tool that feels nothing will touch the body if it goes on.
#pragma once

#include <optional>

#include "lobe/sim/world.h"

namespace lobe {

struct Approach {
  Vec3d normal = Vec3d::UnitZ();  // of the body's surface there, outwards
  double gap = 0;                 // how far the tool has to go against it, negative inside [m]
};

// None: nothing of the body is within `reach` [m]. Looks at the points of the surface at which contact is
// evaluated. `opening`: of jaws, which are taken to stay as far open [m]. Of meshes nothing is known: the
// distance to one is exact only within two cells of its grid.
template <class Real>
std::optional<Approach> approach_of(World<Real>& world, const RigidShape& shape, double opening,
                                    const ToolPose& pose, double reach);

extern template std::optional<Approach> approach_of(World<float>&, const RigidShape&, double, const ToolPose&,
                                                    double);
extern template std::optional<Approach> approach_of(World<double>&, const RigidShape&, double,
                                                    const ToolPose&, double);

}  // namespace lobe
