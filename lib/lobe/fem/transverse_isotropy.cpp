#include "lobe/fem/transverse_isotropy.h"

#include <cmath>

#include "lobe/text.h"

namespace lobe {

// The stiffness C is the inverse of the compliance: with ν_TL = ν_LT E_T/E_L and Δ = 1 − ν_TT − 2 ν_LT ν_TL,
//   C_LL = E_L (1 − ν_TT)/Δ,  C_LT = E_T ν_LT/Δ,  C_TT + C_TT′ = E_T/Δ,  C_TT − C_TT′ = E_T/(1 + ν_TT),
// λ = C_TT′, μ = (C_TT − C_TT′)/2, ε = C_LT − λ, η = G_LT − μ, β = C_LL − λ − 2μ − 2ε − 4η.
void set_transverse(const TransverseConstants& c, Elastic& elastic) {
  const double delta =
      1 - c.poisson_across - 2 * c.poisson_along * c.poisson_along * c.young_across / c.young_along;
  const double sum = c.young_across / delta, difference = c.young_across / (1 + c.poisson_across);
  elastic.mu = difference / 2;
  elastic.lambda = (sum - difference) / 2;
  elastic.fibre.coupling = c.young_across * c.poisson_along / delta - elastic.lambda;
  elastic.fibre.shear = c.shear_along - elastic.mu;
  const double C_LL = c.young_along * (1 - c.poisson_across) / delta;
  elastic.fibre.stretch =
      C_LL - elastic.lambda - 2 * elastic.mu - 2 * elastic.fibre.coupling - 4 * elastic.fibre.shear;
}

// With K = λ + μ = (C_TT + C_TT′)/2: ν_LT = C_LT/2K, E_L = C_LL − C_LT²/K, and E_T, ν_TT follow from the
// plane across when L is free, where K becomes K − C_LT²/C_LL.
TransverseConstants transverse_constants(const Elastic& e) {
  const double K = e.lambda + e.mu, C_LT = e.lambda + e.fibre.coupling, C_LL = stiffness_along(e);
  const double plane = K - C_LT * C_LT / C_LL;
  return {C_LL - C_LT * C_LT / K, 4 * plane * e.mu / (plane + e.mu), C_LT / (2 * K),
          (plane - e.mu) / (plane + e.mu), shear_along(e)};
}

std::vector<Fault> transverse_faults(const TransverseConstants& c, const std::string& place) {
  std::vector<Fault> faults;
  const auto positive = [&](const char* name, double value) {
    if (!(value > 0 && std::isfinite(value)))
      faults.push_back({place + "/" + name, exact(value) + ", must be above 0 and finite"});
  };
  positive("young_modulus_along", c.young_along);
  positive("young_modulus_across", c.young_across);
  positive("shear_modulus_along", c.shear_along);
  if (!(std::abs(c.poisson_across) < 1))
    faults.push_back({place + "/poisson_ratio_across", exact(c.poisson_across) + ", must be within (-1, 1)"});
  if (!faults.empty()) return faults;
  const double bound = std::sqrt((1 - c.poisson_across) * c.young_along / (2 * c.young_across));
  if (!(std::abs(c.poisson_along) < bound))
    faults.push_back(
        {place + "/poisson_ratio_along",
         exact(c.poisson_along) + ", must be within ±" + rounded(bound) +
             " = ±√((1 - poisson_ratio_across) young_modulus_along / (2 young_modulus_across))"});
  return faults;
}

// The energy is a sum over parts of the strain, of which only that along the fibre and that of the area
// across it are coupled: G_LT > 0, μ > 0, λ + μ > 0 and C_LL (λ + μ) > C_LT².
bool is_positive_definite(const Elastic& e) {
  const double K = e.lambda + e.mu, C_LT = e.lambda + e.fibre.coupling, C_LL = stiffness_along(e);
  return std::isfinite(C_LL * K) && e.mu > 0 && shear_along(e) > 0 && K > 0 && C_LL * K > C_LT * C_LT;
}

}  // namespace lobe
