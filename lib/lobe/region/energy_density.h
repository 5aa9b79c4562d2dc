// Energy and stress of one tetrahedron by the model of its region, or by another: what all evaluators of regions sum up.
#pragma once

#include "lobe/fem/elements.h"
#include "lobe/fem/guard.h"
#include "lobe/fem/hooke.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"

namespace lobe {

// Both without nodal pressure, which is no property of one tetrahedron.

// W/V [J/m³]
inline double energy_density(const Elements& elements, Index tet, const Mat3<double>& H,  // ∇u
                             RegionModel model) {
  const Elastic& e = elements.elastic_of(tet);
  if (model != RegionModel::nonlinear) return hooke_energy_density(H, e.lambda, e.mu);
  double W =
      svk_energy_density(H, e.element_lambda(), e.mu) + volume_energy_density(H, elements.volume_penalty);
  if (elements.guard_below > 0) W += guard_energy_density(H, e.guard_modulus(), elements.guard_below);
  return W;
}
inline double energy_density(const Elements& elements, Index tet, const Mat3<double>& H) {
  return energy_density(elements, tet, H, elements.region_of[tet]);
}

// First Piola-Kirchhoff [Pa]
inline Mat3<double> stress(const Elements& elements, Index tet, const Mat3<double>& H,  // ∇u
                           RegionModel model) {
  const Elastic& e = elements.elastic_of(tet);
  if (model != RegionModel::nonlinear) return hooke_stress(H, e.lambda, e.mu);
  Mat3<double> P = svk_stress(H, e.element_lambda(), e.mu) + volume_stress(H, elements.volume_penalty);
  if (1 + volume_change(H) < elements.guard_below)
    P += guard_stress(H, e.guard_modulus(), elements.guard_below);
  return P;
}

}  // namespace lobe
