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

// The left ventricle of a heart: the shell between two half ellipsoids about the z axis, whose centre is the
// origin. It is open at the top, at the plane z = base. Its fibres lie in the layers of the shell. Their
// angle to the horizontal grows linearly through the wall and is positive where a fibre rises
// counter-clockwise seen from above (the rule of Streeter et al., Circulation Research 24, 1969).
struct VentricleShape {
  double inner_radius = 0.022, outer_radius = 0.032;  // [m]
  double inner_length = 0.055, outer_length = 0.065;  // half axes along z, from the centre to the apex [m]
  double base = 0.015;                                // [m]
  double inner_angle = 1.0471975511965976, outer_angle = -1.0471975511965976;  // angles of fibres [rad]: ±60°
};

// Deforms a cylinder mesh so that its axis becomes the apex. Layers go from the inside out, rings from the
// apex to the base: 18 rings² layers tetrahedra in all. Sets the fibres; labels are 0.
TetMesh ventricle_mesh(const VentricleShape& shape, int rings, int layers);

}  // namespace lobe
