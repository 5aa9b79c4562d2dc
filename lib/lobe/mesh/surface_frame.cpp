// Computes what is needed to draw a surface from the vertices of the mesh, in each frame.
#include <Eigen/Geometry>

#include "lobe/mesh/surface.h"

namespace lobe {

template <class Real>
void update_positions(const SurfaceMesh& surface, const Eigen::Ref<const Mat3X<double>>& X,
                      const Eigen::Ref<const Mat3X<std::type_identity_t<Real>>>& u, Mat3X<Real>& x) {
  x.resize(3, surface.vertex_count());
  for (Index i = 0; i < surface.vertex_count(); ++i) {
    const Index v = surface.mesh_vertex[i];
    x.col(i) = (X.col(v) + u.col(v).template cast<double>()).template cast<Real>();
  }
  for (const SurfaceMesh::Within& inner : surface.within) {
    Vec3d sum = Vec3d::Zero();
    for (int k = 0; k < 4; ++k)
      sum += inner.weights[k] * (X.col(inner.corners[k]) + u.col(inner.corners[k]).template cast<double>());
    x.col(inner.vertex) = sum.cast<Real>();
  }
}

template <class Real>
Mat3X<Real> at_surface(const SurfaceMesh& surface, const Eigen::Ref<const Mat3X<Real>>& values) {
  Mat3X<Real> found = values(Eigen::all, surface.mesh_vertex);
  for (const SurfaceMesh::Within& inner : surface.within)
    found.col(inner.vertex) = values(Eigen::all, inner.corners) * inner.weights.cast<Real>();
  return found;
}

template <class Real>
void update_normals(const SurfaceMesh& surface, const Mat3X<Real>& x, Mat3X<Real>& normals) {
  normals.setZero(3, surface.vertex_count());
  for (const Eigen::Vector3i& t : surface.triangles) {
    const Vec3<Real> a = x.col(t[0]);
    const Vec3<Real> twice_area = (x.col(t[1]) - a).cross(x.col(t[2]) - a);
    for (Index vertex : t) normals.col(vertex) += twice_area;
  }
  for (auto normal : normals.colwise()) normal.normalize();
}

double enclosed_volume(const SurfaceMesh& surface, const Mat3X<double>& x) {
  double six_volumes = 0;
  for (const Eigen::Vector3i& t : surface.triangles)
    six_volumes += x.col(t[0]).dot(x.col(t[1]).cross(x.col(t[2])));
  return six_volumes / 6;
}

#define LOBE_INSTANTIATE(Real)                                                                     \
  template void update_positions<Real>(const SurfaceMesh&, const Eigen::Ref<const Mat3X<double>>&, \
                                       const Eigen::Ref<const Mat3X<Real>>&, Mat3X<Real>&);        \
  template Mat3X<Real> at_surface<Real>(const SurfaceMesh&, const Eigen::Ref<const Mat3X<Real>>&); \
  template void update_normals<Real>(const SurfaceMesh&, const Mat3X<Real>&, Mat3X<Real>&);
LOBE_INSTANTIATE(float)
LOBE_INSTANTIATE(double)
#undef LOBE_INSTANTIATE

}  // namespace lobe
