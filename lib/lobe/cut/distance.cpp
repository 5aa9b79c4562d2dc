#include "lobe/cut/distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

Vec3d nearest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double sum = va + vb + vc;
  return a + ab * (vb / sum) + ac * (vc / sum);
}

double distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d ab = b - a;
  const double square = ab.squaredNorm();
  const double share = square > 0 ? std::clamp(ab.dot(p - a) / square, 0.0, 1.0) : 0;
  return (p - a - share * ab).norm();
}

double distance_to_tet(const Vec3d& p, const Mat34<double>& x) {
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (int f = 0; f < 4; ++f) {
    const Vec3d a = x.col(face_corners[f][0]), b = x.col(face_corners[f][1]), c = x.col(face_corners[f][2]);
    const Vec3d normal = (b - a).cross(c - a);
    const double side = normal.dot(p - a), opposite = normal.dot(x.col(f) - a);
    inside = inside && side * opposite > 0;
    nearest = std::min(nearest, (p - nearest_on_triangle(p, a, b, c)).norm());
  }
  return inside ? 0 : nearest;
}

}  // namespace lobe
