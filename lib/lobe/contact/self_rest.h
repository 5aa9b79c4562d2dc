// What contact of a body with itself needs of its surface at rest: the boundary layer, the points whose
// motion is followed, and the parts of the layer. It is built once per surface.
#pragma once

#include "lobe/contact/boundary_layer.h"
#include "lobe/contact/self_points.h"

namespace lobe {

struct SelfRest {
  using Four = Eigen::Vector4i;  // layers of one part that are near each other, −1 where there is none

  BoundaryLayer boundary;
  SelfPoints points;  // places at rest: vertices of the layer, then points of the surface
  std::vector<Eigen::Vector4i> places_of;  // per layer: places of its corners
  std::vector<int> place_of_point;         // per point of the surface
  double mean_edge = 0;                    // mean edge of the surface [m]
  double near = 0;                         // gap of pairs that are always looked at [m]
  std::vector<std::uint8_t> body_of;       // per layer

  // How often the edges of a triangle of one body are divided for points that touch another body; 0: the
  // triangles of the other one, which are smaller, have all points. A body touches itself at all points.
  int divisions(int own, int other) const {
    return several_bodies_ ? divisions_[std::size_t(own * bodies_ + other)] : self_divisions;
  }
  // The mean edge of the coarser one of two bodies over that of all.
  double edge_ratio(int own, int other) const {
    return several_bodies_ ? edge_ratios_[std::size_t(own * bodies_ + other)] : 1;
  }
  // How far apart triangles of one body and tetrahedra of another are looked for, but for a factor: the mean
  // edge of the two, but no more than that of all, and no less than a tenth of it [m].
  double reach(int own, int other) const {
    return several_bodies_ ? reaches_[std::size_t(own * bodies_ + other)] : mean_edge;
  }
  double least_reach() const { return least_reach_; }  // of all pairs of bodies [m]
  bool has_several_bodies() const { return several_bodies_; }
  bool is_one_sided(int own, int other) const { return divisions(other, own) == 0; }

  // Parts: of near tetrahedra of one body with what triangles they own.
  std::vector<std::vector<int>> parts;     // places of their points, ascending
  std::vector<std::uint8_t> body_of_part;  // ascending
  std::vector<int> part_of_triangle, part_of_layer;
  std::vector<Four> fours;      // part by part
  std::vector<int> first_four;  // per part, and their number

  void rebuild(const ContactSurface& surface, const Elements& elements);
  const BoundaryLayer::Tet& layer(int number) const { return boundary.tets()[std::size_t(number)]; }

 private:
  void choose_divisions(const ContactSurface& surface, const MeshBodies& bodies);
  void choose_reaches(const ContactSurface& surface);
  void take_points(const ContactSurface& surface, const Elements& elements);
  void divide_into_parts(const ContactSurface& surface);
  void find_parts_of_layers(const std::vector<Vec3d>& centres);
  void divide_into_fours(const std::vector<Vec3d>& centres);

  bool several_bodies_ = false;
  int bodies_ = 1;
  std::vector<int> divisions_;       // divisions of triangles of one body for another: bodies_ × bodies_
  std::vector<double> edge_ratios_;  // ratios of mean edges, in the same order
  std::vector<double> reaches_;      // [m], in the same order
  double least_reach_ = 0;           // [m]
};

}  // namespace lobe
