// Linear elasticity: W = V (λ/2 (tr ε)² + μ tr ε²), ε = ½(∇u + ∇uᵀ). [PDA] section 2.2.
#pragma once

#include "lobe/types.h"

namespace lobe {

template <class T>
T hooke_energy_density(const Mat3<T>& H,              // ∇u
                       const T& lambda, const T& mu)  // [Pa] → [J/m³]
{
  const Mat3<T> e = (H + H.transpose()) * T(0.5f);
  const T trace = e(0, 0) + e(1, 1) + e(2, 2);
  return T(0.5f) * lambda * trace * trace + mu * e.cwiseProduct(e).sum();
}

template <class T>
Mat3<T> hooke_stress(const Mat3<T>& H, const T& lambda, const T& mu)  // σ [Pa]
{
  const T pressure = lambda * (H(0, 0) + H(1, 1) + H(2, 2));
  Mat3<T> stress = (H + H.transpose()) * mu;
  for (int i = 0; i < 3; ++i) stress(i, i) += pressure;
  return stress;
}

// ∂²W/∂u_j∂u_k = V B_jk, B_jk = λ α_j⊗α_k + μ (α_k⊗α_j + (α_j·α_k) I). [PDA] eq. (3)
// sums these blocks without the ½ of the energy (erratum 1).
template <class Real>
inline Mat3<Real> hooke_block(const Vec3<Real>& alpha_j, const Vec3<Real>& alpha_k, Real lambda,
                              Real mu)  // [Pa/m²]
{
  Mat3<Real> block = lambda * alpha_j * alpha_k.transpose() + mu * alpha_k * alpha_j.transpose();
  block.diagonal().array() += mu * alpha_j.dot(alpha_k);
  return block;
}

}  // namespace lobe
