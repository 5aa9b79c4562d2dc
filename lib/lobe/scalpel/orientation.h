// Decides on which side of a plane a point lies. It is the one decision of the scalpel that rounding must not
// change.
#pragma once

#include "lobe/types.h"

namespace lobe {

// The sign of det[a − d, b − d, c − d], exactly: 1, −1, or 0 for four points in one plane. A filter decides
// all but nearly flat cases; these are summed without rounding (Shewchuk 1997, theorem 10). Finite values
// whose products of three neither overflow nor underflow.
int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

// Both return the sign of det[a − d, b − d, c − d], with a rule for 0. side_of_plane() says on which
// side of the plane of a, b and c the point d of a body lies. side_of_line() says on which side of the
// line a b the line c d of a body passes. Where the sign is 0, the body is taken to be moved by
// (ε, ε², ε³) with an infinitely small ε, so that all decisions are consistent. The result is 0 only if
// a, b and c lie in one line, or if the lines are parallel.
int side_of_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
int side_of_line(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

}  // namespace lobe
