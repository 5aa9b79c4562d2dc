// Decides on which side of a plane a point lies. It is the one decision of the scalpel that rounding must not
// change.
#pragma once

#include "lobe/types.h"

namespace lobe {

// The sign of det[a − d, b − d, c − d], exactly: 1, −1, or 0 for four points in one plane. A filter decides
// all but nearly flat cases; these are summed without rounding (Shewchuk 1997, theorem 10). Finite values
// whose products of three neither overflow nor underflow.
int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

// On which side of a plane a point of a body lies, and on which side of the line through a and b the line
// through c and d of a body passes. Ties are decided as if the body were moved by (ε, ε², ε³) with an
// infinitely small ε: so they fit each other in all triangles. 0: d is on no plane, as a, b and c are in one
// line; or the lines are parallel.
int side_of_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
int side_of_line(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

}  // namespace lobe
