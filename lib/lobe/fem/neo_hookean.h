// Compressible neo-Hookean solid, in place of St Venant-Kirchhoff: with J = det F,
//   W/V = μ/2 (tr FᵀF − 3) − μ (J − 1) + (λ + μ)/2 (J − 1)²
//   P   = μ F + ψ′ cof F,  ψ′ = (λ + μ)(J − 1) − μ
// (B. Smith, F. de Goes, T. Kim, Stable neo-Hookean flesh simulation, ACM Trans. Graph. 37, 2018, without
// their logarithm, in the Lamé coefficients of the small strains that are Hooke's). It is polyconvex and does
// not soften in uniaxial compression. Its energy is finite for every F, inverted ones too.
#pragma once

#include "lobe/fem/solid.h"
#include "lobe/fem/volume_term.h"
#include "lobe/types.h"

namespace lobe {

// μ/2 (tr FᵀF − 3) − μ (J − 1) = μ (½ H:H − minors of H − det H), in which what is linear in H cancels.
template <class T>
T neo_hookean_energy_density(const Mat3<T>& H, const T& lambda, const T& mu)  // [Pa] → [J/m³]
{
  const T v = volume_change(H), beyond_trace = v - (H(0, 0) + H(1, 1) + H(2, 2));
  return mu * (T(0.5f) * H.cwiseProduct(H).sum() - beyond_trace) + T(0.5f) * (lambda + mu) * v * v;
}

template <class T>
VolumeDerivatives<T> neo_hookean_volume_derivatives(const Mat3<T>& H, const T& lambda, const T& mu)  // [Pa]
{
  return {(lambda + mu) * volume_change(H) - mu, lambda + mu};
}

// P = μ (F − cof F) + (λ + μ)(J − 1) cof F. F − cof F is computed without the 1 of F, so that P is exactly 0
// at rest.
template <class T>
Mat3<T> neo_hookean_stress(const Mat3<T>& H, const T& lambda, const T& mu)  // first Piola-Kirchhoff [Pa]
{
  // cof(I + H) = I + tr(H) I − Hᵀ + cof H
  const T trace = H(0, 0) + H(1, 1) + H(2, 2), pressure = (lambda + mu) * volume_change(H);
  Mat3<T> beyond = cofactor(H) - H.transpose();  // cof F − I
  for (int i = 0; i < 3; ++i) beyond(i, i) += trace;
  Mat3<T> P = (H - beyond) * mu + beyond * pressure;
  for (int i = 0; i < 3; ++i) P(i, i) += pressure;
  return P;
}

// ∂²W/∂u_j² / V = μ (α·α) I + (λ + μ) g⊗g, g = cof(F) α_j (det F is linear in each vertex).
template <class T>
Mat3<T> neo_hookean_diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const T& lambda,
                                   const T& mu)  // [Pa/m²]
{
  const Vec3<T> g = deformation_cofactor(H).lazyProduct(alpha);
  const T shear = mu * alpha.cwiseProduct(alpha).sum();
  Mat3<T> block = g.lazyProduct(g.transpose()) * (lambda + mu);
  for (int i = 0; i < 3; ++i) block(i, i) += shear;
  return block;
}

struct NeoHookean {  // solid.h
  static constexpr bool in_green_strain = false;
  template <class T>
  LOBE_INLINE static T energy_density(const Mat3<T>& H, const Law<T>& law) {
    return neo_hookean_energy_density(H, law.lambda, law.mu);
  }
  template <class T>
  LOBE_INLINE static Mat3<T> stress(const Mat3<T>& H, const Law<T>& law) {
    return neo_hookean_stress(H, law.lambda, law.mu);
  }
  template <class T>
  LOBE_INLINE static Mat3<T> diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const Law<T>& law) {
    return neo_hookean_diagonal_block(H, alpha, law.lambda, law.mu);
  }
  template <class T>
  LOBE_INLINE static void add_second_order(const Mat3<T>& H, const Law<T>& law, SecondOrder<T>& sum) {
    sum.S += law.mu * Mat3<T>::Identity();
    sum.psi += neo_hookean_volume_derivatives(H, law.lambda, law.mu);
  }
  static const char* fault(const Law<double>&) { return ""; }
};

}  // namespace lobe
