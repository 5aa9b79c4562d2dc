// The term that one fibre direction adds to an isotropic law (A. J. M. Spencer, Constitutive theory for
// strongly anisotropic solids, 1984). With a unit vector a at rest, A = a⊗a, and a strain E,
//   W/V = ε I₄ tr E + 2η I₅ + β/2 I₄²,   I₄ = a·E a,   I₅ = a·E² a
//   S   = ε (I₄ I + tr(E) A) + 2η (A E + E A) + β I₄ A.
// With λ (tr E)²/2 + μ tr E² these are the five constants of a transversely isotropic solid; theory, section
// 2. E is Green's strain in the non-linear model (svk.h), its linear part in the linear one (hooke.h).
#pragma once

#include "lobe/fem/law_moduli.h"
#include "lobe/fem/svk.h"
#include "lobe/types.h"

namespace lobe {

template <class T>
T fibre_energy_of_strain(const Mat3<T>& E, const FibreModuli<T>& fibre, const Vec3<T>& a)  // [J/m³]
{
  const Vec3<T> Ea = E.lazyProduct(a);
  const T along = a.cwiseProduct(Ea).sum(), trace = E(0, 0) + E(1, 1) + E(2, 2);
  return fibre.coupling * along * trace + T(2) * fibre.shear * Ea.cwiseProduct(Ea).sum() +
         T(0.5f) * fibre.stretch * along * along;
}

// S = ε I₄ I + a⊗h + h⊗a, h = 2η E a + ½ (ε tr E + β I₄) a.
template <class T>
Mat3<T> fibre_stress_of_strain(const Mat3<T>& E, const FibreModuli<T>& fibre, const Vec3<T>& a)  // [Pa]
{
  const Vec3<T> Ea = E.lazyProduct(a);
  const T along = a.cwiseProduct(Ea).sum(), trace = E(0, 0) + E(1, 1) + E(2, 2);
  const Vec3<T> h =
      Ea * (fibre.shear + fibre.shear) + a * (T(0.5f) * (fibre.coupling * trace + fibre.stretch * along));
  Mat3<T> S;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i <= j; ++i) S(i, j) = S(j, i) = a[i] * h[j] + h[i] * a[j];
  for (int i = 0; i < 3; ++i) S(i, i) += fibre.coupling * along;
  return S;
}

// ∂²W/∂u_j∂u_k / V of the linear model, p_j = a·α_j:
//   ε (p_j a⊗α_k + p_k α_j⊗a) + (β p_j p_k + η α_j·α_k) a⊗a + η (p_j p_k I + p_j α_k⊗a + p_k a⊗α_j).
template <class Real>
Mat3<Real> fibre_block(const Vec3<Real>& alpha_j, const Vec3<Real>& alpha_k, const FibreModuli<Real>& fibre,
                       const Vec3<Real>& a)  // [Pa/m²]
{
  const Real pj = a.dot(alpha_j), pk = a.dot(alpha_k);
  const Vec3<Real> left = fibre.coupling * pj * alpha_k + fibre.shear * pk * alpha_j,
                   right = fibre.coupling * pk * alpha_j + fibre.shear * pj * alpha_k;
  Mat3<Real> block = a * left.transpose() + right * a.transpose() +
                     (fibre.stretch * pj * pk + fibre.shear * alpha_j.dot(alpha_k)) * a * a.transpose();
  block.diagonal().array() += fibre.shear * pj * pk;
  return block;
}

template <class T>
T fibre_energy_density(const Mat3<T>& H, const FibreModuli<T>& fibre, const Vec3<T>& a)  // [Pa] → [J/m³]
{
  return fibre_energy_of_strain<T>(green_strain(H), fibre, a);
}

template <class T>
Mat3<T> fibre_second_stress(const Mat3<T>& H, const FibreModuli<T>& fibre, const Vec3<T>& a)  // [Pa]
{
  return fibre_stress_of_strain<T>(green_strain(H), fibre, a);
}

// ∂²W/∂u_j² / V = (α·Sα) I + F B_jj Fᵀ, B of fibre_block(), α = α_j.
template <class T>
Mat3<T> fibre_diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const FibreModuli<T>& fibre,
                             const Vec3<T>& a)  // [Pa/m²]
{
  const Mat3<T> S = fibre_second_stress(H, fibre, a);
  const Vec3<T> Fa = a + H.lazyProduct(a), Falpha = alpha + H.lazyProduct(alpha),
                Salpha = S.lazyProduct(alpha);
  Mat3<T> F = H;
  for (int i = 0; i < 3; ++i) F(i, i) += T(1);
  const T p = a.cwiseProduct(alpha).sum(), aa = alpha.cwiseProduct(alpha).sum();
  const Vec3<T> h = Falpha * (p * (fibre.coupling + fibre.shear)) +
                    Fa * (T(0.5f) * (fibre.stretch * p * p + fibre.shear * aa));
  Mat3<T> block = F.lazyProduct(F.transpose()) * (fibre.shear * p * p) + Fa.lazyProduct(h.transpose()) +
                  h.lazyProduct(Fa.transpose());
  const T geometric = alpha.cwiseProduct(Salpha).sum();
  for (int i = 0; i < 3; ++i) block(i, i) += geometric;
  return block;
}

}  // namespace lobe
