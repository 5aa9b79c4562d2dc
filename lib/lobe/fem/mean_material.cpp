#include "lobe/fem/mean_material.h"

#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {

MeanMaterial mean_material(const Elements& elements, const std::vector<Index>& tets) {
  double volume = 0, lambda = 0, mu = 0, nodal_lambda = 0, neo_hookean = 0;
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
    if (e.law == MaterialLaw::neo_hookean) neo_hookean += V;
    if (!e.fibre.any()) continue;
    fibre += e.fibre.times(V);
    structure += V * elements.fibre_of(t) * elements.fibre_of(t).transpose();
  }
  MeanMaterial mean{.volume = volume};
  mean.material.lambda = lambda / volume;
  mean.material.mu = mu / volume;
  mean.material.nodal_pressure = nodal_lambda > 0 ? nodal_lambda / lambda : 0;
  mean.material.law = neo_hookean > volume / 2 ? MaterialLaw::neo_hookean : MaterialLaw::svk;
  mean.material.fibre = fibre.times(1 / volume);
  if (fibre.any()) mean.direction = symmetric_eigen(structure).vectors.col(2);
  return mean;
}

}  // namespace lobe
