// The energy of one tetrahedron by the model of its region: what all evaluators of regions sum up.
#pragma once

#include "lobe/fem/guard.h"
#include "lobe/fem/hooke.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"
#include "lobe/region/elements.h"

namespace lobe {

// W/V without nodal pressure, which is no property of one tetrahedron. [J/m³]
inline double energy_density(const Elements& elements, Index tet, const Mat3<double>& H)  // ∇u
{
  const Elastic& e = elements.elastic_of(tet);
  if (elements.region_of[tet] != RegionModel::nonlinear) return hooke_energy_density(H, e.lambda, e.mu);
  double W =
      svk_energy_density(H, e.element_lambda(), e.mu) + volume_energy_density(H, elements.volume_penalty);
  if (elements.guard_below > 0) W += guard_energy_density(H, e.guard_modulus(), elements.guard_below);
  return W;
}

}  // namespace lobe
