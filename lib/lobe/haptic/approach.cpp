#include "lobe/haptic/approach.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lobe/contact/quadrature.h"
#include "lobe/contact/signed_distance.h"
#include "lobe/contact/touch_points.h"

namespace lobe {

template <class Real>
std::optional<Approach> approach_of(World<Real>& world, const RigidShape& shape, double opening,
                                    const ToolPose& pose, double reach) {
  if (shape.kind == RigidShape::Kind::mesh) return std::nullopt;
  const SignedDistance distance(shape);
  const Mat3<double> to_tool =
      Eigen::Quaterniond(pose.orientation).normalized().toRotationMatrix().transpose();
  const SurfaceMesh& surface = world.surface().mesh();
  Mat3X<Real> now;
  update_positions(surface, world.elements().points.view(), world.displacements(), now);
  const Mat3X<double> x = to_tool * (now.template cast<double>().colwise() - pose.position);
  std::optional<Approach> nearest;
  for (const Eigen::Vector3i& corners : surface.triangles) {
    const Vec3d a = x.col(corners[0]), b = x.col(corners[1]), c = x.col(corners[2]);
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    const double least = distance.reach() + opening / 2 + std::max(0.0, nearest ? nearest->gap : reach);
    // No point of it is farther from a corner than its longest edge, and (p + q)² ≤ 2 p² + 2 q².
    if (std::min({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()}) > 2 * (least * least + longest))
      continue;
    Mat3<double> y;
    y << a, b, c;
    const int n = std::clamp(static_cast<int>(std::ceil(std::sqrt(longest) / (distance.fineness() / 2))), 2,
                             most_divisions);
    visit_centroids(n, [&](int, const Vec3d& weights) {
      const Distance found = distance.at(y * weights, opening);
      if (found.value > (nearest ? nearest->gap : reach)) return;
      nearest = {.normal = -(to_tool.transpose() * found.gradient), .gap = found.value};
    });
  }
  return nearest;
}

template std::optional<Approach> approach_of(World<float>&, const RigidShape&, double, const ToolPose&,
                                             double);
template std::optional<Approach> approach_of(World<double>&, const RigidShape&, double, const ToolPose&,
                                             double);

}  // namespace lobe
