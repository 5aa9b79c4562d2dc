// Energy and stress of one tetrahedron or smoothing domain, by the model of its region or by a given one.
// Energies of regions are sums of these.
#pragma once

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/fem/smoothed_edge.h"

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

// Both for a smoothing domain, which has neither volume term nor guard.
inline double energy_density(const Elements& elements, const SmoothedEdge& edge, const Mat3<double>& H,
                             RegionModel model, double pressure = 0) {  // mean of both ends [Pa]
  if (is_linear(model)) return linear_energy_density(smoothed_linear_law(elements, edge), H);
  return law_energy_density(smoothed_law(elements, edge, pressure), H);
}
inline Mat3<double> stress(const Elements& elements, const SmoothedEdge& edge, const Mat3<double>& H,
                           RegionModel model, double pressure = 0) {
  if (is_linear(model)) return linear_stress(smoothed_linear_law(elements, edge), H);
  return law_stress(smoothed_law(elements, edge, pressure), H);
}

// What a tetrahedron has by itself: all, or, if its element is smoothed, volume term and guard.
inline double unsmoothed_energy_density(const Elements& elements, Index tet, const Mat3<double>& H,
                                        RegionModel model, double pressure = 0) {
  if (!elements.elastic_of(tet).is_smoothed()) return energy_density(elements, tet, H, model, pressure);
  return is_linear(model) ? 0 : law_energy_density(unsmoothed_law(elements, tet), H);
}
inline Mat3<double> unsmoothed_stress(const Elements& elements, Index tet, const Mat3<double>& H,
                                      RegionModel model, double pressure = 0) {
  if (!elements.elastic_of(tet).is_smoothed()) return stress(elements, tet, H, model, pressure);
  return is_linear(model) ? Mat3<double>::Zero() : law_stress(unsmoothed_law(elements, tet), H);
}

}  // namespace lobe
