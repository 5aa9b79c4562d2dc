// Viscosity by a Prony series: beside a solid of slow moduli, which it has when it is at rest for long, lie
// branches, each a spring in series with a dashpot. In Green's strain E, with Hooke's C_i of λ_i and μ_i,
//   S = S_law(E) + Σ_i C_i:(E − A_i),  dA_i/dt = (E − A_i)/τ_i
// (J. C. Simo, T. J. R. Hughes, Computational Inelasticity, 1998, section 10.2, with A_i the strain of the
// dashpot). After a sudden strain the shear modulus falls from that at once, μ + Σ μ_i, to the slow one, μ. A
// rotation changes neither E nor A_i, so it costs nothing.
//
// Step: A_i is known at half steps, as velocities are. From t − h/2 to t + h/2 the strain counts as E(t),
// and with d = exp(−h/2τ) both lines are exact for that:
//   E − A(t)       = d (E − A(t − h/2))
//   E − A(t + h/2) = d² (E − A(t − h/2))
// It is of order 2, is stable for every h/τ, and never stiffer than at once.
//
// The law of a material may be any (law.h). Its branches are the same, with λ and μ those of small strains.
#pragma once

#include <cmath>
#include <span>
#include <tuple>

#include "lobe/types.h"

namespace lobe {

struct PronyTerm {
  double shear = 0;  // share of the shear modulus at once that relaxes
  double bulk = 0;   // share of the bulk modulus at once that relaxes
  double time = 0;   // τ [s]; 0: there is no term

  bool operator==(const PronyTerm&) const = default;
  static constexpr auto fields = std::tuple(&PronyTerm::shear, &PronyTerm::bulk, &PronyTerm::time);
};
inline constexpr std::size_t most_prony_terms = 3;  // of a material

// What is wrong with the series; empty: nothing.
inline const char* prony_fault(std::span<const PronyTerm> series) {
  double shear = 0, bulk = 0;
  if (series.size() > most_prony_terms) return "a Prony series has at most 3 terms";
  for (const PronyTerm& term : series) {
    if (!(term.time > 0 && std::isfinite(term.time))) return "a time of a Prony series must be above 0";
    if (!(term.shear >= 0 && term.bulk >= 0)) return "a share of a Prony series must be at least 0";
    if (term.shear == 0 && term.bulk == 0)
      return "a term of a Prony series needs a share of shear or of bulk";
    shear += term.shear;
    bulk += term.bulk;
  }
  if (!(shear < 1)) return "the shares of shear of a Prony series must sum to less than 1: all would relax";
  if (!(bulk < 1)) return "the shares of bulk of a Prony series must sum to less than 1: all would relax";
  return "";
}

// The modulus of shear, or of bulk, at once over the slow one.
inline double at_once(std::span<const PronyTerm> series, double PronyTerm::*share) {
  double relaxing = 0;
  for (const PronyTerm& term : series) relaxing += term.*share;
  return 1 / (1 - relaxing);
}

// G(t) after a sudden strain, G′(ω) and G″(ω) of a vibration. The modulus of bulk has the same functions.
struct ViscousModulus {
  double slow;  // [Pa]
  std::span<const PronyTerm> series;
  double PronyTerm::*share = &PronyTerm::shear;

  double relaxed(double t) const {  // [s] → [Pa]
    return sum([&](double time) { return std::exp(-t / time); });
  }
  double storage(double omega) const {  // [rad/s] → [Pa]
    return sum([&](double time) { return omega * time * omega * time / (1 + omega * time * omega * time); });
  }
  double loss(double omega) const {  // [rad/s] → [Pa]
    return sum([&](double time) { return omega * time / (1 + omega * time * omega * time); }) - slow;
  }

 private:
  template <class Weight>
  double sum(Weight&& weight) const {
    const double whole = slow * at_once(series, share);
    double modulus = slow;
    for (const PronyTerm& term : series) modulus += whole * (term.*share) * weight(term.time);
    return modulus;
  }
};

template <class T>
struct ViscousBranch {
  T lambda{}, mu{};  // λ_i, μ_i [Pa]
  T half{};          // exp(−h/2τ), of a step h
};

// The branch of one term beside a solid of slow λ and μ [Pa], for steps of `step` [s].
inline ViscousBranch<double> viscous_branch(std::span<const PronyTerm> series, std::size_t term,
                                            double lambda, double mu, double step) {
  const double K = (lambda + 2 * mu / 3) * at_once(series, &PronyTerm::bulk) * series[term].bulk,
               G = mu * at_once(series, &PronyTerm::shear) * series[term].shear;
  return {K - 2 * G / 3, G, std::exp(-step / (2 * series[term].time))};
}

// C_i:(E − A(t)) [Pa], with `A` of half a step before.
template <class T>
Mat3<T> viscous_stress(const Mat3<T>& E, const Mat3<T>& A, const ViscousBranch<T>& branch) {
  const Mat3<T> elastic = (E - A) * branch.half;
  const T pressure = branch.lambda * (elastic(0, 0) + elastic(1, 1) + elastic(2, 2));
  Mat3<T> S = elastic * (branch.mu + branch.mu);
  for (int i = 0; i < 3; ++i) S(i, i) += pressure;
  return S;
}

// A half a step later.
template <class T>
Mat3<T> followed_strain(const Mat3<T>& E, const Mat3<T>& A, const ViscousBranch<T>& branch) {
  return E - (E - A) * (branch.half * branch.half);
}

}  // namespace lobe
