// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/sizing.h"

#include <algorithm>
#include <limits>

#include "lobe_mesh/model.h"

namespace lobe::meshing {

Sizing::Sizing(const Model& model, const MeshOptions& options)
    : model_(model),
      edges_(model.labels.size(), options.edge),
      balls_(options.balls, options.growth),
      growth_(options.growth) {
  for (const auto& [label, edge] : options.label_edges) edges_[model.region_of(label)] = edge;
  shortest_ = *std::min_element(edges_.begin(), edges_.end());
  const double longest = *std::max_element(edges_.begin(), edges_.end());
  for (const SizeBall& ball : options.balls) shortest_ = std::min(shortest_, ball.edge);
  uniform_ = shortest_ == longest;
  if (uniform_) return;
  for (const Surface& surface : model.surfaces) surfaces_.emplace_back(surface);
}

double Sizing::distance_to_region(const Vec3d& point, int region) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    const Sides& sides = model_.sides[k];
    if (sides.inside == region || sides.outside == region)
      nearest = std::min(nearest, surfaces_[k].distance(point));
  }
  return nearest;
}

double Sizing::operator()(const Vec3d& point, int region) const {
  if (uniform_) return shortest_;
  double edge = std::numeric_limits<double>::infinity();
  for (int k = 0; k < static_cast<int>(edges_.size()); ++k) {
    if (edges_[k] < edge)
      edge = std::min(edge, edges_[k] + (k == region ? 0 : growth_ * distance_to_region(point, k)));
  }
  return balls_.at(point, edge);
}

}  // namespace lobe::meshing
