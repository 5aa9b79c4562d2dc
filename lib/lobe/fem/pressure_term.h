// The part of a law that nodal pressure takes over (theory, section 12): with a given pressure p,
//   W = V p θ/2,  P = p ∂θ/∂F.
// For St Venant-Kirchhoff θ = tr E, and ∂θ/∂F = F. For other laws θ = J − 1, J = det F, and ∂θ/∂F = cof F:
// they resist a change of J, which tr E does not tell in far stretched material. The formulas of the law are
// called with (1 − χ)λ and μ.
#pragma once

#include "lobe/fem/law_moduli.h"
#include "lobe/fem/volume_term.h"
#include "lobe/types.h"

namespace lobe {

template <class T>
T strain_trace(const Mat3<T>& H)  // tr E = tr H + ½ H:H
{
  return H(0, 0) + H(1, 1) + H(2, 2) + T(0.5f) * H.cwiseProduct(H).sum();
}

template <class T>
__attribute__((always_inline)) inline T pressure_strain(const Mat3<T>& H, MaterialLaw law)  // θ
{
  return averages_green_strain(law) ? strain_trace(H) : volume_change(H);
}

template <class T>
Mat3<T> pressure_slope_less_one(const Mat3<T>& H, MaterialLaw law)  // ∂θ/∂F − I
{
  if (averages_green_strain(law)) return H;
  Mat3<T> D = cofactor(H) - H.transpose();  // cof F = I + tr(H) I − Hᵀ + cof H
  const T trace = H(0, 0) + H(1, 1) + H(2, 2);
  for (int i = 0; i < 3; ++i) D(i, i) += trace;
  return D;
}

template <class T>
T pressure_energy_density(const Mat3<T>& H, const T& p, MaterialLaw law)  // [Pa] → [J/m³]
{
  return T(0.5f) * p * pressure_strain(H, law);
}

// Adds to the first Piola-Kirchhoff stress [Pa].
template <class T>
Mat3<T> pressure_stress(const Mat3<T>& H, const T& p, MaterialLaw law) {
  if (!averages_green_strain(law)) return deformation_cofactor(H) * p;
  Mat3<T> P = H * p;
  for (int i = 0; i < 3; ++i) P(i, i) += p;
  return P;
}

// ∂²W/∂u_j² / V = p (α·α) I of St Venant-Kirchhoff at given p, α = α_j. J is linear in each vertex.
template <class T>
Mat3<T> pressure_diagonal_block(const Vec3<T>& alpha, const T& p)  // [Pa/m²]
{
  Mat3<T> block = Mat3<T>::Constant(T(0));
  for (int i = 0; i < 3; ++i) block(i, i) = p * alpha.cwiseProduct(alpha).sum();
  return block;
}

}  // namespace lobe
