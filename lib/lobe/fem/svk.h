// St Venant-Kirchhoff: W = V (λ/2 (tr E)² + μ tr E²), E = ½(∇u + ∇uᵀ + ∇uᵀ∇u). [PDA] section 3.1, closed
// form.
//
// It softens under compression (uniaxial peak at stretch 1/√3) and does not resist inversion: volume_term.h
// does.
#pragma once

#include "lobe/fem/hooke.h"
#include "lobe/fem/solid.h"
#include "lobe/types.h"

namespace lobe {

template <class T>
Mat3<T> green_strain(const Mat3<T>& H)  // E from ∇u
{
  return (H + H.transpose() + H.transpose().lazyProduct(H)) * T(0.5f);
}

template <class T>
T svk_energy_density(const Mat3<T>& H, const T& lambda, const T& mu)  // [Pa] → [J/m³]
{
  const Mat3<T> E = green_strain(H);
  const T trace = E(0, 0) + E(1, 1) + E(2, 2);
  return T(0.5f) * lambda * trace * trace + mu * E.cwiseProduct(E).sum();
}

template <class T>
Mat3<T> svk_second_stress(const Mat3<T>& H, const T& lambda, const T& mu)  // S = λ tr(E) I + 2μ E [Pa]
{
  const Mat3<T> E = green_strain(H);
  const T pressure = lambda * (E(0, 0) + E(1, 1) + E(2, 2));
  Mat3<T> S = E * (mu + mu);
  for (int i = 0; i < 3; ++i) S(i, i) += pressure;
  return S;
}

template <class T>
Mat3<T> svk_stress(const Mat3<T>& H, const T& lambda, const T& mu)  // first Piola-Kirchhoff P = F S [Pa]
{
  const Mat3<T> S = svk_second_stress(H, lambda, mu);
  return S + H.lazyProduct(S);
}

// ∂²W/∂u_j² / V = (α·Sα) I + (λ + μ)(Fα)⊗(Fα) + μ (α·α) F Fᵀ at the current state, α = α_j. It is the
// stiffness that a vertex feels when it moves while its neighbours are held, and determines the time step.
template <class T>
LOBE_INLINE inline Mat3<T> svk_diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const T& lambda,
                                              const T& mu)  // [Pa/m²]
{
  const Mat3<T> S = svk_second_stress(H, lambda, mu);
  const Vec3<T> Fa = alpha + H.lazyProduct(alpha);
  Mat3<T> F = H;
  for (int i = 0; i < 3; ++i) F(i, i) += T(1);
  const T aa = alpha.cwiseProduct(alpha).sum();
  const Vec3<T> Sa = S.lazyProduct(alpha);
  Mat3<T> block = Fa.lazyProduct(Fa.transpose()) * (lambda + mu) + F.lazyProduct(F.transpose()) * (mu * aa);
  const T geometric = alpha.cwiseProduct(Sa).sum();
  for (int i = 0; i < 3; ++i) block(i, i) += geometric;
  return block;
}

struct Svk {  // solid.h
  static constexpr bool in_green_strain = true;
  template <class T>
  LOBE_INLINE static T energy_density(const Mat3<T>& H, const Law<T>& law) {
    return svk_energy_density(H, law.lambda, law.mu);
  }
  template <class T>
  LOBE_INLINE static Mat3<T> second_stress(const Mat3<T>& H, const Law<T>& law) {
    return svk_second_stress(H, law.lambda, law.mu);
  }
  template <class T>
  LOBE_INLINE static Mat3<T> stress(const Mat3<T>& H, const Law<T>& law) {
    return svk_stress(H, law.lambda, law.mu);
  }
  template <class T>
  LOBE_INLINE static Mat3<T> diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const Law<T>& law) {
    return svk_diagonal_block(H, alpha, law.lambda, law.mu);
  }
  template <class T>
  LOBE_INLINE static Mat3<T> green_block(const Vec3<T>& alpha_j, const Vec3<T>& alpha_k, const Law<T>& law) {
    return hooke_block<T>(alpha_j, alpha_k, law.lambda, law.mu);
  }
  template <class T>
  LOBE_INLINE static void add_second_order(const Mat3<T>& H, const Law<T>& law, SecondOrder<T>& sum) {
    sum.S += second_stress(H, law);
  }
  static const char* fault(const Law<double>&) { return ""; }
};

}  // namespace lobe
