#include "lobe/fem/mean_material.h"

#include <algorithm>

#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {

MeanMaterial mean_material(const Elements& elements, const std::vector<Index>& tets) {
  double volume = 0, lambda = 0, mu = 0, nodal_lambda = 0;
  std::array<double, law_count> volume_of{};  // per law
  std::array<std::array<double, 2>, law_count> further{};
  std::array<double, law_count> angle{};
  std::array<std::array<double, 3>, law_count> plane{};
  FibreModuli<double> fibre;
  Mat3<double> structure = Mat3<double>::Zero();  // ∫ a⊗a where there are fibres
  for (Index t : tets) {
    if (!elements.topology.alive(t)) continue;
    const double V = elements.shape_of(t).volume;
    const Elastic& e = elements.elastic_of(t);
    volume += V;
    lambda += V * e.lambda;
    mu += V * e.mu;
    nodal_lambda += V * e.nodal_lambda();
    volume_of[std::size_t(e.law)] += V;
    for (std::size_t i = 0; i < e.further.size(); ++i) further[std::size_t(e.law)][i] += V * e.further[i];
    angle[std::size_t(e.law)] += V * e.fibre_angle;
    for (std::size_t i = 0; i < 3; ++i) plane[std::size_t(e.law)][i] += V * e.fibre_plane[i];
    if (!e.has_direction()) continue;
    fibre += e.fibre.times(V);
    structure += V * elements.fibre_of(t) * elements.fibre_of(t).transpose();
  }
  MeanMaterial mean;
  mean.volume = volume;
  mean.material.lambda = lambda / volume;
  mean.material.mu = mu / volume;
  mean.material.nodal_pressure = nodal_lambda > 0 ? nodal_lambda / lambda : 0;
  const auto most = std::max_element(volume_of.begin(), volume_of.end()) - volume_of.begin();
  mean.material.law = MaterialLaw(most);
  for (std::size_t i = 0; i < further[0].size(); ++i)
    mean.material.further[i] = further[std::size_t(most)][i] / volume_of[std::size_t(most)];
  mean.material.fibre_angle = angle[std::size_t(most)] / volume_of[std::size_t(most)];
  for (std::size_t i = 0; i < 3; ++i)
    mean.material.fibre_plane[i] = plane[std::size_t(most)][i] / volume_of[std::size_t(most)];
  mean.material.fibre = fibre.times(1 / volume);
  if (mean.material.has_direction() && !structure.isZero(0))
    mean.direction = symmetric_eigen(structure).vectors.col(2);
  return mean;
}

}  // namespace lobe
