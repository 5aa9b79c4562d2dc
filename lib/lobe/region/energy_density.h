// Energy and stress of one tetrahedron, by the model of its region or by a given one. Energies of regions are
// sums of these.
#pragma once

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"

namespace lobe {

// W/V [J/m³]
inline double energy_density(const Elements& elements, Index tet, const Mat3<double>& H,  // ∇u
                             RegionModel model, double pressure = 0) {  // mean of its nodes' [Pa]
  if (is_linear(model)) return linear_energy_density(linear_law(elements, tet), H);
  return law_energy_density(nonlinear_law(elements, tet, pressure), H);
}
inline double energy_density(const Elements& elements, Index tet, const Mat3<double>& H) {
  return energy_density(elements, tet, H, elements.region_of[tet]);
}

// First Piola-Kirchhoff [Pa]
inline Mat3<double> stress(const Elements& elements, Index tet, const Mat3<double>& H,  // ∇u
                           RegionModel model, double pressure = 0) {
  if (is_linear(model)) return linear_stress(linear_law(elements, tet), H);
  return law_stress(nonlinear_law(elements, tet, pressure), H);
}

}  // namespace lobe
