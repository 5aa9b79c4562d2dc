// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// How far a mesh is from the surfaces that it was made of, and what would keep the parts that it lost.
#pragma once

#include <vector>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/nearest.h"
#include "lobe_mesh/steps.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

// Points on all parts of a surface, at most about `spacing` apart, with the area that each stands for.
struct SurfacePoint {
  Vec3d point, normal;  // outwards, of unit length
  double area = 0;
  Index triangle = 0;       // triangle of the surface
  std::size_t surface = 0;  // its number, where there are several
};
std::vector<SurfacePoint> points_on(const Surface& surface, double spacing, std::size_t number = 0);

// The distances of one surface's points from another surface, weighted by area.
SurfaceGap gap_between(const std::vector<SurfacePoint>& points, const NearestPoint& other);

// Boundary and interfaces of a mesh, as one surface.
Surface faces_of_surfaces(const TetMesh& mesh);

// The body's width around a point of its surface: the diameter of the largest ball inside that touches the
// surface there; at most `most`.
double width_at(const SurfacePoint& at, const NearestPoint& surface, double most);

// What would keep the parts of a surface that a mesh lost: edges shorter than the body is wide there, and
// points to start from. A refinement that starts elsewhere does not come upon a thin part.
struct Remedy {
  std::vector<SizeBall> balls;
  std::vector<Seed> seeds;  // about an edge apart
};

// The remedy for all points that are further than `bound` from the mesh. Empty, if there are none.
Remedy remedy_for(const std::vector<SurfacePoint>& points, const NearestPoint& surface,
                  const NearestPoint& mesh, double bound, double spacing);

}  // namespace lobe::meshing
