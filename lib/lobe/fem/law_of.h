// The law that a material, or a tetrahedron of a body, follows.
#pragma once

#include <cmath>

#include "lobe/fem/elements.h"
#include "lobe/fem/law_moduli.h"

namespace lobe {

// Beyond an exponent of 16 the stress of fibres grows linearly.
inline FibreFamilies<double> fibre_families(const Elastic& elastic) {
  if (!has_families(elastic.law)) return {};
  const double k2 = elastic.further[1];
  return {.stiffening = k2,
          .most = k2 > 1e-6 ? 4 / std::sqrt(k2) : 4e3,
          .along = std::cos(elastic.fibre_angle),
          .aside = std::sin(elastic.fibre_angle),
          .plane = elastic.fibre_plane};
}

// The law of corotational tetrahedra of a material: with all of λ, and no other term.
inline Law<double> corotational_law(const Elastic& elastic) {
  return {.lambda = elastic.lambda,
          .mu = elastic.mu,
          .kappa = 0,
          .pressure = 0,
          .guard_modulus = 0,
          .guard_threshold = 0,
          .terms = {.solid = MaterialLaw::corotational}};
}
// The law of non-linear tetrahedra of a material, without the direction of a fibre.
inline Law<double> nonlinear_law(const Elastic& elastic, double volume_penalty, double guard_below,
                                 double pressure = 0) {  // p_T, the mean of its nodes' [Pa]
  return {.lambda = elastic.element_lambda(),
          .mu = elastic.mu,
          .kappa = volume_penalty,
          .pressure = pressure,
          .guard_modulus = elastic.guard_modulus(),
          .guard_threshold = guard_below,
          .terms = {.solid = elastic.law,
                    .volume = volume_penalty > 0,
                    .pressure = pressure != 0,
                    .guard = guard_below > 0,
                    .fibre = elastic.fibre.any()},
          .fibre = elastic.fibre,
          .further = elastic.further,
          .families = fibre_families(elastic)};
}
// The law of a tetrahedron of a body, whose model is not linear.
inline Law<double> nonlinear_law(const Elements& elements, Index tet, double pressure = 0) {
  if (elements.region_of[tet] == RegionModel::corotational) return corotational_law(elements.elastic_of(tet));
  Law<double> law =
      nonlinear_law(elements.elastic_of(tet), elements.volume_penalty, elements.guard_below, pressure);
  law.direction = elements.fibre_of(tet);
  return law;
}
// The part of the law of a material that is evaluated at the strain of each tetrahedron, in a region of any
// model that is not linear: all, or, if the element is smoothed, the volume term and the guard. Moduli of the
// other terms are 0.
inline Law<double> unsmoothed_law(const Elements& elements, const Elastic& elastic, RegionModel model) {
  Law<double> law = model == RegionModel::corotational
                        ? corotational_law(elastic)
                        : nonlinear_law(elastic, elements.volume_penalty, elements.guard_below);
  if (!elastic.is_smoothed()) return law;
  law.lambda = law.mu = 0;
  law.fibre = {};
  law.further = {};
  law.terms = {.solid = MaterialLaw::none, .volume = law.terms.volume, .guard = law.terms.guard};
  return law;
}
inline Law<double> unsmoothed_law(const Elements& elements, Index tet) {
  if (!elements.elastic_of(tet).is_smoothed()) return nonlinear_law(elements, tet);
  return unsmoothed_law(elements, elements.elastic_of(tet), elements.region_of[tet]);
}
// The law of linear tetrahedra, for linear_stress() and similar functions: with all of λ, and no other term
// than the fibre's.
inline Law<double> linear_law(const Elastic& elastic) {
  return {.lambda = elastic.lambda,
          .mu = elastic.mu,
          .kappa = 0,
          .pressure = 0,
          .guard_modulus = 0,
          .guard_threshold = 0,
          .terms = {.fibre = elastic.fibre.any()},
          .fibre = elastic.fibre};
}
inline Law<double> linear_law(const Elements& elements, Index tet) {
  Law<double> law = linear_law(elements.elastic_of(tet));
  law.direction = elements.fibre_of(tet);
  return law;
}

}  // namespace lobe
