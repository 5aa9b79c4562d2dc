// Predicts where a tool that does not touch the body yet will touch it.
#pragma once

#include <optional>

#include "lobe/sim/world.h"

namespace lobe {

struct Approach {
  Vec3d normal = Vec3d::UnitZ();  // normal of the body's surface there, outwards
  double gap = 0;                 // how far the tool has to go against it, negative inside [m]
};

// Finds the point of the surface that is nearest to a tool. Returns none if it is further than `reach` [m],
// or if the shape is a mesh, whose distance is exact only within two cells of its grid. It looks at the
// points at which contact is evaluated. `opening`: of jaws, taken to be constant [m]. O(#triangles).
template <class Real>
std::optional<Approach> approach_of(World<Real>& world, const RigidShape& shape, double opening,
                                    const ToolPose& pose, double reach);

extern template std::optional<Approach> approach_of(World<float>&, const RigidShape&, double, const ToolPose&,
                                                    double);
extern template std::optional<Approach> approach_of(World<double>&, const RigidShape&, double,
                                                    const ToolPose&, double);

}  // namespace lobe
