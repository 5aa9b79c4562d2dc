// The five engineering constants of a transversely isotropic solid, and the moduli of fibre_term.h that they
// stand for (theory, section 2). L is along the fibre, T across it.
#pragma once

#include "lobe/error.h"
#include "lobe/fem/body.h"

namespace lobe {

struct TransverseConstants {
  double young_along = 0;     // E_L [Pa]
  double young_across = 0;    // E_T [Pa]
  double poisson_along = 0;   // ν_LT: how much T shrinks when L is stretched; ν_TL = ν_LT E_T/E_L
  double poisson_across = 0;  // ν_TT, within the plane across
  double shear_along = 0;     // G_LT [Pa]
};

// Sets λ, μ and the fibre's moduli. The constants of an isotropic solid give one, to rounding.
void set_transverse(const TransverseConstants& constants, Elastic& elastic);
TransverseConstants transverse_constants(const Elastic& elastic);

// The stiffness in uniaxial strain along and across the fibre [Pa]: ρ c² of pressure waves in that direction.
inline double stiffness_across(const Elastic& e) { return e.lambda + 2 * e.mu; }
inline double stiffness_along(const Elastic& e) { return stiffness_across(e) + e.fibre_excess(); }
inline double shear_along(const Elastic& e) { return e.mu + e.fibre.shear; }  // G_LT [Pa]

// Returns a fault for each bound that is broken. Its place is place + '/' + the scene's name of the constant.
std::vector<Fault> transverse_faults(const TransverseConstants& constants, const std::string& place);
// Whether every strain of the linear model has a positive energy.
bool is_positive_definite(const Elastic& elastic);

}  // namespace lobe
