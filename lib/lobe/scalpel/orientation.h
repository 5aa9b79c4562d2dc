// Decides on which side of a plane a point lies. It is the one decision of the scalpel that rounding must not
// change.
#pragma once

#include "lobe/types.h"

namespace lobe {

// The sign of det[a − d, b − d, c − d], exactly: 1, −1, or 0 for four points in one plane. A filter decides
// all but nearly flat cases; these are summed without rounding (Shewchuk 1997, theorem 10). Finite values
// whose products of three neither overflow nor underflow.
int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

// The same with a tie decided once: 0 counts as 1 in the order a < b, and as −1 in the other. Triangles that
// share the line through a and b therefore agree on which side of it a line through c and d passes.
int side_of_line(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

}  // namespace lobe
