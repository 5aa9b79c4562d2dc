// Distances and their smooth combinations, from which organs are modelled: negative inside, positive outside,
// in metres. Only the zero set is exact for the ellipsoid and for what is built with it; near it the value is
// the distance to first order, which is all that meshing and blending need.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace organs {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

// Ellipsoid with centre c and radii r [m]: d = k (k − 1) / g with k = |q/r|, g = |q/r²|, q = p − c: the
// implicit function k − 1 divided by the length of its gradient g / k.
inline double ellipsoid(const Vec3& p, const Vec3& c, const Vec3& r) {
  const Vec3 q = (p - c).cwiseQuotient(r);
  const double k = q.norm();
  const double g = q.cwiseQuotient(r).norm();
  return g > 0 ? k * (k - 1) / g : -r.minCoeff();
}

// The same, turned about the y axis through its centre: a positive angle [rad] lifts its +x end.
inline double tilted_ellipsoid(const Vec3& p, const Vec3& c, const Vec3& r, double angle) {
  return ellipsoid(c + Eigen::AngleAxisd(angle, Vec3::UnitY()) * (p - c), c, r);
}

// Where the foot of the perpendicular from p falls on the segment a-b, in [0, 1].
template <class Vec>
double foot_on_segment(const Vec& p, const Vec& a, const Vec& b) {
  return std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
}

template <class Vec>
double distance_to_segment(const Vec& p, const Vec& a, const Vec& b) {
  return (p - a - foot_on_segment(p, a, b) * (b - a)).norm();
}

// Smooth union: min(a, b) − h² k / 4 with h = max(1 − |a − b| / k, 0). It differs from the minimum only where
// |a − b| < k [m], is once differentiable, and fills a right-angled corner with a fillet of radius about k.
inline double smooth_union(double a, double b, double k) {
  const double h = std::max(1 - std::abs(a - b) / k, 0.0);
  return std::min(a, b) - h * h * k / 4;
}

// What lies in a but not in b, its edge rounded over the width k [m].
inline double smooth_subtraction(double a, double b, double k) { return -smooth_union(-a, b, k); }

}  // namespace organs
