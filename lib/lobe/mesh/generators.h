// Structured meshes of simple bodies, for tests, benchmarks and examples.
#pragma once

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

// The box [0, size] of nx × ny × nz cells, each split into six tetrahedra around its diagonal from the lower
// to the upper corner (Kuhn); conforming and positively oriented, labels 0. Vertex (i, j, k) is number
// i + (nx+1) (j + (ny+1) k), the six tetrahedra of cell (i, j, k) begin at 6 (i + nx (j + ny k)).
TetMesh box_mesh(Vec3d size,  // [m], all > 0
                 int nx, int ny, int nz);

// The cylinder x² + y² <= radius², 0 <= z <= length. Each of its layers + 1 discs has one vertex on the axis
// and 6 r on ring r = 1 … rings (regular hexagons blown up to circles), the first of each ring on the x axis;
// prisms between discs are split into three tetrahedra, 18 rings² layers in all. Conforming and positively
// oriented, labels 0; its lateral surface is inscribed, so its volume is slightly below π radius² length.
TetMesh cylinder_mesh(double radius,  // [m]
                      double length,  // [m]
                      int rings, int layers);

}  // namespace lobe
