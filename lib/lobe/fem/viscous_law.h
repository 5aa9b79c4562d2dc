// A law beside the branches of a Prony series (prony.h), of which S is known: what the wide kernels of
// viscous tetrahedra add up. Without branches law.h has the same.
#pragma once

#include "lobe/fem/law.h"
#include "lobe/fem/svk.h"

namespace lobe {

template <class T>
Mat3<T> law_stress_beside(const Law<T>& law, const Mat3<T>& H,
                          const Mat3<T>& branches)  // S of all branches → P of the whole [Pa]
{
  Mat3<T> S = branches;
  with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE {
    if constexpr (solid.in_green_strain) S += solid.second_stress(H, law);
  });
  if (law.terms.fibre) S += fibre_second_stress(H, law.fibre, law.direction);
  Mat3<T> P = S + H.lazyProduct(S);
  with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE {
    if constexpr (!solid.in_green_strain) P += solid.stress(H, law);
  });
  if (law.terms.volume) P += volume_stress(H, law.kappa);
  if (law.terms.pressure) P += pressure_stress(H, law.pressure, law.terms.solid);
  if (is_guarded(law, H)) P += guard_stress(H, law.guard_modulus, law.guard_threshold);
  return P;
}

// ∂²W/∂u_j² / V of the branches at once, Σ C_i:(E − A_i) with A_i held: as St Venant-Kirchhoff's of Σλ_i and
// Σμ_i, at the stress that is left without Q = Σ C_i:A_i.
template <class T>
LOBE_INLINE inline Mat3<T> branches_diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const T& lambda,
                                                   const T& mu, const Mat3<T>& Q)  // [Pa] → [Pa/m²]
{
  Mat3<T> block = svk_diagonal_block(H, alpha, lambda, mu);
  const Vec3<T> Qa = Q.lazyProduct(alpha);
  const T given_way = alpha.cwiseProduct(Qa).sum();
  for (int i = 0; i < 3; ++i) block(i, i) -= given_way;
  return block;
}

}  // namespace lobe
