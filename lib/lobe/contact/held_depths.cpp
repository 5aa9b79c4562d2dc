#include "lobe/contact/held_depths.h"

#include <algorithm>

namespace lobe {

void HeldDepths::use(const ContactSurface& surface) {
  if (revision_ == surface.revision()) return;
  revision_ = surface.revision();
  now_.assign(surface.points().size(), 0);
  sums_.assign(surface.points().size(), {});
  points_.clear();
  next_points_.clear();
  triangles_.clear();
  most_ = 0;
  const auto& triangles = surface.triangles();
  auto own = triangles.begin();
  for (const OfTriangle& kept : kept_) {
    const auto is_before = [&](const FaceOwner& owner) {
      return std::pair(owner.tet, owner.code) < std::pair(kept.tet, kept.code);
    };
    while (own != triangles.end() && is_before(own->owner)) ++own;
    if (own == triangles.end()) break;
    if (own->owner.tet != kept.tet || own->owner.code != kept.code) continue;
    for (int c = 0; c < 3; ++c) {
      now_[std::size_t(own->points[c])] = kept.depth[c];
      points_.push_back(own->points[c]);
    }
    most_ = std::max(most_, kept.depth.maxCoeff());
  }
}

void HeldDepths::begin() {
  for (int p : next_points_) sums_[std::size_t(p)] = {};
  next_points_.clear();
  triangles_.clear();
  next_.clear();
  next_most_ = 0;
}

void HeldDepths::add(int triangle, const Eigen::Vector3i& points, const Vec3d& weights, double k,
                     double depth) {
  if (triangles_.empty() || triangles_.back() != triangle) {
    triangles_.push_back(triangle);
    next_points_.insert(next_points_.end(), points.begin(), points.end());
  }
  for (int c = 0; c < 3; ++c) {
    Sum& sum = sums_[std::size_t(points[c])];
    sum.depth += k * weights[c] * depth;
    sum.weight += k * weights[c];
  }
}

void HeldDepths::end(const ContactSurface& surface, const ContactLaw& law, double time) {
  for (int t : triangles_) {
    const ContactSurface::Triangle& triangle = surface.triangles()[std::size_t(t)];
    OfTriangle& kept = next_.emplace_back(OfTriangle{triangle.owner.tet, triangle.owner.code, Vec3d::Zero()});
    for (int c = 0; c < 3; ++c) {
      const auto p = std::size_t(triangle.points[c]);
      const Sum& sum = sums_[p];
      const double depth = sum.weight > 0 ? sum.depth / sum.weight : 0;
      kept.depth[c] = law.held_after(time, depth, now_[p]);
    }
    next_most_ = std::max(next_most_, kept.depth.maxCoeff());
  }
}

void HeldDepths::end_step() {
  for (int p : points_) now_[std::size_t(p)] = 0;
  points_.swap(next_points_);
  std::swap(kept_, next_);
  most_ = next_most_;
  for (std::size_t i = 0; i < kept_.size(); ++i)
    for (int c = 0; c < 3; ++c) now_[std::size_t(points_[3 * i + std::size_t(c)])] = kept_[i].depth[c];
  for (int p : points_) sums_[std::size_t(p)] = {};
}

}  // namespace lobe
