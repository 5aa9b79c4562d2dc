#include "lobe/mesh/tet_mesh.h"

#include <Eigen/LU>

namespace lobe {

Mat34<double> tet_points(const TetMesh& mesh, Index tet) {
  Mat34<double> corners;
  for (int k = 0; k < 4; ++k) corners.col(k) = mesh.points.col(mesh.tets(k, tet));
  return corners;
}

// V = det[X1−X0, X2−X0, X3−X0] / 6
double total_volume(const TetMesh& mesh) {
  double volume = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) volume += signed_volume(tet_points(mesh, t));
  return volume;
}

Vec3d barycentre(const TetMesh& mesh, Index tet) { return tet_points(mesh, tet).rowwise().mean(); }

Box bounding_box(const TetMesh& mesh) {
  if (mesh.tet_count() == 0) return {};
  Box box{mesh.points.col(mesh.tets(0, 0)), mesh.points.col(mesh.tets(0, 0))};
  for (Index v : mesh.tets.reshaped()) {
    box.min = box.min.cwiseMin(mesh.points.col(v));
    box.max = box.max.cwiseMax(mesh.points.col(v));
  }
  return box;
}

}  // namespace lobe
