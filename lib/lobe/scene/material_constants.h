// Elastic constants in the forms that people use. λ, μ Lamé [Pa]; E Young [Pa]; ν Poisson [-]; ρ [kg/m³].
#pragma once

#include <cmath>

namespace lobe {

struct LamePair {
  double lambda = 0, mu = 0;  // [Pa]
};

// λ = Eν / ((1+ν)(1−2ν)), μ = E / (2(1+ν))
inline LamePair lame_from_young(double E, double nu) {
  return {E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))};
}

inline double young_modulus(double lambda, double mu) { return mu * (3 * lambda + 2 * mu) / (lambda + mu); }
inline double poisson_ratio(double lambda, double mu) { return lambda / (2 * (lambda + mu)); }

// The speed of pressure waves, c_p = √((λ + 2μ)/ρ) [m/s].
inline double wave_speed(double lambda, double mu, double density) {
  return std::sqrt((lambda + 2 * mu) / density);
}

}  // namespace lobe
