#include "lobe/fem/smoothed_edge.h"

#include <algorithm>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {
namespace {

// The unit vector d for which Σ V_T (d·a_T)² is largest: a direction a and −a are one fibre.
Vec3d principal_direction(const Elements& elements, std::span<const Index> tets) {
  if (elements.fibres.cols() == 0) return Vec3d::Zero();
  Mat3<double> A = Mat3<double>::Zero();
  for (Index t : tets) {
    const Vec3d a = elements.fibre_of(t);
    A += elements.volume(t) * a * a.transpose();
  }
  return symmetric_eigen(A).vectors.col(2);
}

}  // namespace

void find_smoothed_edge(const Elements& elements, Index a, Index b, std::span<const Index> tets,
                        SmoothedEdge& edge) {
  edge.vertices = {a, b};
  edge.gradients.assign(2, Vec3d::Zero());
  edge.volume = 0;
  for (Index t : tets) {
    const Shape s = elements.shape_of(t);
    edge.volume += s.volume / 6;
    for (int c = 0; c < 4; ++c) {
      const Index v = elements.topology.tets()(c, t);
      const auto at = std::find(edge.vertices.begin(), edge.vertices.end(), v) - edge.vertices.begin();
      if (std::size_t(at) == edge.vertices.size()) {
        edge.vertices.push_back(v);
        edge.gradients.push_back(Vec3d::Zero());
      }
      edge.gradients[std::size_t(at)] += s.volume / 6 * s.gradients.col(c);
    }
  }
  if (tets.empty()) return;
  for (Vec3d& gradient : edge.gradients) gradient /= edge.volume;
  edge.direction = principal_direction(elements, tets);
  edge.material = elements.material_of[std::size_t(tets[0])];
  edge.model = elements.region_of[std::size_t(tets[0])];
}

Law<double> smoothed_linear_law(const Elements& elements, const SmoothedEdge& edge) {
  Law<double> law = linear_law(elements.materials[edge.material]);
  law.direction = edge.direction;
  return law;
}

Law<double> smoothed_law(const Elements& elements, const SmoothedEdge& edge, double pressure) {
  const Elastic& material = elements.materials[edge.material];
  Law<double> law = edge.model == RegionModel::corotational ? corotational_law(material)
                                                            : nonlinear_law(material, 0, 0, pressure);
  law.direction = edge.direction;
  return law;
}

}  // namespace lobe
