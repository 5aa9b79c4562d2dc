// The part of St Venant-Kirchhoff that nodal pressure takes over (theory, section 12): with a given pressure
// p, W = V p θ/2 and S = p I, θ = tr E. These are added to the functions of svk.h, which are called with (1 −
// χ)λ and μ.
#pragma once

#include "lobe/types.h"

namespace lobe {

template <class T>
T strain_trace(const Mat3<T>& H)  // θ = tr E = tr H + ½ H:H
{
  return H(0, 0) + H(1, 1) + H(2, 2) + T(0.5f) * H.cwiseProduct(H).sum();
}

template <class T>
T pressure_energy_density(const Mat3<T>& H, const T& p)  // [Pa] → [J/m³]
{
  return T(0.5f) * p * strain_trace(H);
}

template <class T>
Mat3<T> pressure_stress(const Mat3<T>& H, const T& p)  // adds p F to the first Piola-Kirchhoff stress [Pa]
{
  Mat3<T> P = H * p;
  for (int i = 0; i < 3; ++i) P(i, i) += p;
  return P;
}

// ∂²W/∂u_j² / V = p (α·α) I at given p, α = α_j.
template <class T>
Mat3<T> pressure_diagonal_block(const Vec3<T>& alpha, const T& p)  // [Pa/m²]
{
  Mat3<T> block = Mat3<T>::Constant(T(0));
  for (int i = 0; i < 3; ++i) block(i, i) = p * alpha.cwiseProduct(alpha).sum();
  return block;
}

}  // namespace lobe
