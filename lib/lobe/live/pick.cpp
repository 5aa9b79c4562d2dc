#include "lobe/live/pick.h"

#include <Eigen/Geometry>
#include <limits>

#include "lobe/diagnostics/locate.h"

namespace lobe {

// Möller and Trumbore: origin + t d = a + β (b − a) + γ (c − a).
template <class Real>
std::optional<RayHit> cast_ray(const SurfaceMesh& surface, const Mat3X<Real>& x, const Vec3d& origin,
                               const Vec3d& direction) {
  const Vec3d d = direction.normalized();
  std::optional<RayHit> hit;
  double nearest = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < surface.triangle_count(); ++i) {
    const Eigen::Vector3i& corner = surface.triangles[std::size_t(i)];
    const Vec3d a = x.col(corner[0]).template cast<double>();
    const Vec3d ab = x.col(corner[1]).template cast<double>() - a;
    const Vec3d ac = x.col(corner[2]).template cast<double>() - a;
    const double towards = -d.dot(ab.cross(ac));  // above 0 where it enters
    if (!(towards > 0)) continue;
    const Vec3d from = origin - a, side = from.cross(d);
    const double beta = ac.dot(side) / towards, gamma = -ab.dot(side) / towards;
    if (beta < 0 || gamma < 0 || beta + gamma > 1) continue;
    const double t = from.dot(ab.cross(ac)) / towards;
    if (t < 0 || t >= nearest) continue;
    nearest = t;
    hit = RayHit{i, origin + t * d};
  }
  return hit;
}

template <class Real>
bool lies_in(const Topology& topology, Eigen::Ref<const Mat3X<double>> X, Eigen::Ref<const Mat3X<Real>> u,
             const Vec3d& point) {
  for (Index t = 0; t < topology.tet_count(); ++t) {
    if (!topology.alive(t)) continue;
    const Eigen::Vector4i corners = topology.corners(t);
    Mat34<double> x;
    for (int i = 0; i < 4; ++i) x.col(i) = X.col(corners[i]) + u.col(corners[i]).template cast<double>();
    if ((x.rowwise().minCoeff().array() > point.array()).any()) continue;
    if ((x.rowwise().maxCoeff().array() < point.array()).any()) continue;
    if (barycentric(x, point).minCoeff() >= 0) return true;
  }
  return false;
}

template bool lies_in<float>(const Topology&, Eigen::Ref<const Mat3X<double>>, Eigen::Ref<const Mat3X<float>>,
                             const Vec3d&);
template bool lies_in<double>(const Topology&, Eigen::Ref<const Mat3X<double>>,
                              Eigen::Ref<const Mat3X<double>>, const Vec3d&);
template std::optional<RayHit> cast_ray(const SurfaceMesh&, const Mat3X<float>&, const Vec3d&, const Vec3d&);
template std::optional<RayHit> cast_ray(const SurfaceMesh&, const Mat3X<double>&, const Vec3d&, const Vec3d&);

}  // namespace lobe
