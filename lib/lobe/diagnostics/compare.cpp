#include "lobe/diagnostics/compare.h"

#include <cmath>
#include <limits>

#include "lobe/error.h"
#include "lobe/fem/shape.h"

namespace lobe {
namespace {

double ratio(double difference, double reference) {
  if (difference == 0) return 0;
  return reference > 0 ? difference / reference : std::numeric_limits<double>::infinity();
}

// ∫|w|² over one tetrahedron of volume V: V/20 (Σ|w_i|² + |Σ w_i|²).
double l2_square(const Mat34<double>& w, double volume) {
  return volume / 20 * (w.squaredNorm() + w.rowwise().sum().squaredNorm());
}

}  // namespace

Difference compare_displacements(const TetMesh& mesh, const Mat3X<double>& a, const Mat3X<double>& b) {
  if (a.cols() != mesh.vertex_count() || b.cols() != mesh.vertex_count())
    throw InputError("displacement", "one column per vertex of the mesh is needed");
  Difference d;
  double l2[2] = {}, h1[2] = {};
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Shape s = shape(tet_points(mesh, t));
    const Mat3<double> alpha = s.gradients.rightCols<3>();
    Mat34<double> at_a, at_b;
    for (int c = 0; c < 4; ++c) {
      at_a.col(c) = a.col(mesh.tets(c, t));
      at_b.col(c) = b.col(mesh.tets(c, t));
    }
    const Mat34<double> w = at_a - at_b;
    l2[0] += l2_square(w, s.volume);
    l2[1] += l2_square(at_b, s.volume);
    h1[0] += s.volume * displacement_gradient(w, alpha).squaredNorm();
    h1[1] += s.volume * displacement_gradient(at_b, alpha).squaredNorm();
    const Mat34<double> X = tet_points(mesh, t);
    d.volume_a += signed_volume(X + at_a);
    d.volume_b += signed_volume(X + at_b);
  }
  d.l2 = std::sqrt(ratio(l2[0], l2[1]));
  d.h1 = std::sqrt(ratio(h1[0], h1[1]));
  if (mesh.vertex_count() > 0) {
    Eigen::Index worst = 0;
    d.max = (a - b).colwise().norm().maxCoeff(&worst);
    d.worst_vertex = static_cast<Index>(worst);
    d.relative_max = ratio(d.max, b.colwise().norm().maxCoeff());
  }
  return d;
}

}  // namespace lobe
