// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// The length of edges that is asked for at each point.
#pragma once

#include <memory>
#include <vector>

#include "lobe_mesh/nearest.h"
#include "lobe_mesh/size_balls.h"
#include "lobe_mesh/tetrahedralise.h"

namespace lobe::meshing {

struct Model;

// The largest field that nowhere exceeds an edge asked for and grows by at most `growth` per length: the
// minimum over labels and balls of their edge + growth × distance to them.
class Sizing {
 public:
  Sizing(const Model& model, const MeshOptions& options);

  bool uniform() const { return uniform_; }
  double shortest() const { return shortest_; }  // [m]
  // Edge at a point [m]; `region`: that it lies in, −1 if it is on a surface.
  double operator()(const Vec3d& point, int region) const;

 private:
  double distance_to_region(const Vec3d& point, int region) const;

  const Model& model_;
  std::vector<double> edges_;  // edge of each region
  SizeBalls balls_;
  std::vector<NearestPoint> surfaces_;
  double growth_ = 0, shortest_ = 0;
  bool uniform_ = true;
};

}  // namespace lobe::meshing
