// The distance of a triangle from a tetrahedron.
#pragma once

#include "lobe/types.h"

namespace lobe {

// From the point of the tetrahedron that is nearest to the triangle to the point of the triangle that is
// nearest to the tetrahedron; if they meet, any. [m]
Vec3d shortest_way(const Mat34<double>& tet, const Mat3<double>& triangle);

}  // namespace lobe
