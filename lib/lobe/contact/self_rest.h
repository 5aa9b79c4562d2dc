// What contact of a body with itself needs of its surface at rest: the boundary layer, the points whose
// motion is followed, and the parts of the layer. It is built once per surface.
#pragma once

#include "lobe/contact/boundary_layer.h"
#include "lobe/contact/self_points.h"

namespace lobe {

struct SelfRest {
  using Four = Eigen::Vector4i;  // layers of one part that are near each other, −1 where there is none

  BoundaryLayer boundary;
  SelfPoints points;                       // at rest: vertices of the layer, points of the surface
  std::vector<Eigen::Vector4i> places_of;  // per layer: places of its corners
  std::vector<int> place_of_point;         // per point of the surface
  double mean_edge = 0;                    // of the surface [m]
  double near = 0;                         // gap of pairs that are always looked at [m]

  // Parts: of near tetrahedra with what triangles they own.
  std::vector<std::vector<int>> parts;  // places of their points, ascending
  std::vector<int> part_of_triangle;
  std::vector<Four> fours;      // part by part
  std::vector<int> first_four;  // per part, and their number

  void rebuild(const ContactSurface& surface, const Elements& elements);
  const BoundaryLayer::Tet& layer(int number) const { return boundary.tets()[std::size_t(number)]; }

 private:
  void take_points(const ContactSurface& surface, const Elements& elements);
  void divide_into_parts(const ContactSurface& surface);
  void divide_into_fours(const std::vector<Vec3d>& centres, const std::vector<int>& part_of_layer);
};

}  // namespace lobe
