// The law of a tetrahedron of the non-linear model: its energy is the sum of a solid's (svk.h, neo_hookean.h,
// yeoh.h, mooney_rivlin.h, holzapfel.h, corotational.h) and of the terms of fibre_term.h, volume_term.h,
// pressure_term.h and guard.h. All code that evaluates such tetrahedra calls the functions below: wide
// kernels, energies, the solvers' tangent, the time step, the estimate of linear regions' errors. A new solid
// is a struct of formulas (solid.h) in `Solids`, and a row in law_moduli.h. The order in which a function
// sums the terms up decides the last bits of results.
//
// Only the given terms are evaluated. If `terms` are constants, as in kernels, the other terms are not even
// compiled.
#pragma once

#include <Eigen/Geometry>
#include <tuple>
#include <utility>

#include "lobe/fem/corotational.h"
#include "lobe/fem/fibre_term.h"
#include "lobe/fem/guard.h"
#include "lobe/fem/holzapfel.h"
#include "lobe/fem/hooke.h"
#include "lobe/fem/law_moduli.h"
#include "lobe/fem/mooney_rivlin.h"
#include "lobe/fem/neo_hookean.h"
#include "lobe/fem/pressure_term.h"
#include "lobe/fem/solid.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"
#include "lobe/fem/yeoh.h"

namespace lobe {

using Solids =
    std::tuple<Svk, NeoHookean, Yeoh, MooneyRivlin, Holzapfel, Corotational>;  // in the order of MaterialLaw
static_assert(std::tuple_size_v<Solids> == solid_count);

// Calls visit(solid) with the formulas of a law; not for `none`. Always inline, as are the functions that it
// is given: a kernel, whose law is a constant, then has no other.
template <int i = 0, class Visit>
LOBE_INLINE constexpr void with_solid(MaterialLaw law, const Visit& visit) {
  if (law == MaterialLaw(i)) return visit(std::tuple_element_t<i, Solids>{});
  if constexpr (i + 1 < solid_count) with_solid<i + 1>(law, visit);
}

template <class T>
bool is_guarded(const Law<T>& law, const Mat3<T>& H)  // whether the guard resists, in any lane
{
  return law.terms.guard && any_of(T(1) + volume_change(H) < law.guard_threshold);
}

// S of the terms in Green's strain, without nodal pressure.
template <class T>
Mat3<T> law_second_stress(const Law<T>& law, const Mat3<T>& H)  // [Pa]
{
  SumOfTerms<Mat3<T>> S(Mat3<T>::Constant(T(0)));
  with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE {
    if constexpr (solid.in_green_strain) S += solid.second_stress(H, law);
  });
  if (law.terms.fibre) S += fibre_second_stress(H, law.fibre, law.direction);
  return S.value();
}

template <class T>
T law_energy_density(const Law<T>& law, const Mat3<T>& H)  // W/V of ∇u [J/m³]
{
  SumOfTerms<T> W(T(0));
  with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE { W += solid.energy_density(H, law); });
  if (law.terms.fibre) W += fibre_energy_density(H, law.fibre, law.direction);
  if (law.terms.volume) W += volume_energy_density(H, law.kappa);
  if (law.terms.pressure) W += pressure_energy_density(H, law.pressure, law.terms.solid);
  if (is_guarded(law, H)) W += guard_energy_density(H, law.guard_modulus, law.guard_threshold);
  return W.value();
}

template <class T>
Mat3<T> law_stress(const Law<T>& law, const Mat3<T>& H)  // first Piola-Kirchhoff [Pa]
{
  SumOfTerms<Mat3<T>> P(Mat3<T>::Constant(T(0)));
  if (law.terms.fibre) {
    const Mat3<T> S = law_second_stress(law, H);
    P += S + H.lazyProduct(S);
  }
  with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE {
    if (!solid.in_green_strain || !law.terms.fibre) P += solid.stress(H, law);
  });
  if (law.terms.volume) P += volume_stress(H, law.kappa);
  if (law.terms.pressure) P += pressure_stress(H, law.pressure, law.terms.solid);
  if (is_guarded(law, H)) P += guard_stress(H, law.guard_modulus, law.guard_threshold);
  return P.value();
}

// ∂²W/∂u_j² / V of a corner with gradient α, at given nodal pressure: the stiffness that the corner feels
// when it moves while its neighbours are held.
template <class T>
inline Mat3<T> law_diagonal_block(const Law<T>& law, const Mat3<T>& H, const Vec3<T>& alpha)  // [Pa/m²]
{
  SumOfTerms<Mat3<T>> K(Mat3<T>::Constant(T(0)));
  with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE { K += solid.diagonal_block(H, alpha, law); });
  if (law.terms.fibre) K += fibre_diagonal_block(H, alpha, law.fibre, law.direction);
  if (law.terms.volume) K += volume_diagonal_block(H, alpha, law.kappa);
  if (is_guarded(law, H)) K += guard_diagonal_block(H, alpha, law.guard_modulus, law.guard_threshold);
  if (law.terms.pressure && averages_green_strain(law.terms.solid))
    K += pressure_diagonal_block(alpha, law.pressure);
  return K.value();
}

// ∂²W/∂u_j∂u_k / V of all corners, at given nodal pressure, 3 × 3 block by block:
//   terms in Green's strain     (α_j·S α_k) I + F B_jk Fᵀ,  B_jk of hooke.h and fibre_term.h
//   functions of I₁ = tr FᵀF    (α_j·α_k) 2W′ I + 4W″ a_j⊗a_k,  a_j = F α_j
//   functions of I₁ and J       2 ∂²W/∂I₁∂J (a_j⊗g_k + g_j⊗a_k)
//   functions ψ of J = det F    ψ″ g_j⊗g_k + ψ′ ∂g_j/∂x_k,  g_j = cof(F) α_j,  ∂g_j/∂x_k w = w × F(α_j × α_k)
//   of the rotation R           blocks of corotational.h
template <class T>
Eigen::Matrix<T, 12, 12> law_stiffness(const Law<T>& law, const Mat3<T>& H,
                                       const Mat34<T>& alpha)  // of the four corners [1/m] → [Pa/m²]
{
  const Mat3<T> I = Mat3<T>::Identity(), F = I + H;
  SecondOrder<T> sum;
  bool is_green = law.terms.fibre;
  with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE {
    solid.add_second_order(H, law, sum);
    is_green = is_green || solid.in_green_strain;
  });
  if (law.terms.fibre) sum.S += fibre_second_stress(H, law.fibre, law.direction);
  if (law.terms.pressure && averages_green_strain(law.terms.solid))
    sum.S += law.pressure * I;
  else if (law.terms.pressure)
    sum.psi += VolumeDerivatives<T>{law.pressure, T(0)};
  if (law.terms.volume) sum.psi += volume_derivatives(H, law.kappa);
  if (is_guarded(law, H)) sum.psi += guard_derivatives(H, law.guard_modulus, law.guard_threshold);
  const Mat34<T> g = cofactor(F) * alpha, a = F * alpha;
  Eigen::Matrix<T, 12, 12> K;
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k) {
      SumOfTerms<Mat3<T>> B(Mat3<T>::Zero());
      with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE {
        if constexpr (solid.in_green_strain)
          B += solid.template green_block<T>(alpha.col(j), alpha.col(k), law);
      });
      if (law.terms.fibre) B += fibre_block<T>(alpha.col(j), alpha.col(k), law.fibre, law.direction);
      Mat3<T> block = Mat3<T>::Zero();
      if (is_green) block = F * B.value() * F.transpose();
      block.diagonal().array() += alpha.col(j).dot(sum.S.value() * alpha.col(k));
      if (sum.has_invariant)
        block += sum.stretch * a.col(j) * a.col(k).transpose() +
                 sum.mixed * (a.col(j) * g.col(k).transpose() + g.col(j) * a.col(k).transpose());
      const Vec3<T> turned = F * Vec3<T>(alpha.col(j)).cross(Vec3<T>(alpha.col(k)));
      block += sum.psi.value().curvature * g.col(j) * g.col(k).transpose() -
               sum.psi.value().slope * cross_matrix(turned);
      K.template block<3, 3>(3 * j, 3 * k) = block;
    }
  with_solid(law.terms.solid, [&](auto solid) LOBE_INLINE {
    if constexpr (requires { solid.add_stiffness(H, law, alpha, K); }) solid.add_stiffness(H, law, alpha, K);
  });
  return K;
}

// ---- The linear model of the same tetrahedron: terms in the linear strain.

template <class T>
T linear_energy_density(const Law<T>& law, const Mat3<T>& H)  // W/V of ∇u [J/m³]
{
  const T W = hooke_energy_density(H, law.lambda, law.mu);
  if (!law.terms.fibre) return W;
  return W + fibre_energy_of_strain<T>((H + H.transpose()) * T(0.5f), law.fibre, law.direction);
}

template <class T>
Mat3<T> linear_stress(const Law<T>& law, const Mat3<T>& H)  // σ [Pa]
{
  const Mat3<T> stress = hooke_stress(H, law.lambda, law.mu);
  if (!law.terms.fibre) return stress;
  return stress + fibre_stress_of_strain<T>((H + H.transpose()) * T(0.5f), law.fibre, law.direction);
}

template <class T>
inline Mat3<T> linear_block(const Law<T>& law, const Vec3<T>& alpha_j,
                            const Vec3<T>& alpha_k)  // B_jk [Pa/m²]
{
  const Mat3<T> block = hooke_block<T>(alpha_j, alpha_k, law.lambda, law.mu);
  if (!law.terms.fibre) return block;
  return block + fibre_block<T>(alpha_j, alpha_k, law.fibre, law.direction);
}

}  // namespace lobe
