// Mooney and Rivlin's solid, in place of St Venant-Kirchhoff: with J = det F, C = FᵀF, φ = J^(−2/3),
// I₁ = tr C and I₂ = (I₁² − tr C²)/2,
//   W/V = c₁₀ (φ I₁ − 3) + c₀₁ (φ² I₂ − 3) + K/2 (J − 1)²,  c₁₀ = μ/2 − c₀₁,  K = λ + ⅔ μ
//   P   = 2c₁₀ φ F + 2c₀₁ φ² F (I₁ I − C) + (c₁₀ φ′ I₁ + 2c₀₁ φ φ′ I₂ + K (J − 1)) cof F
// (R. S. Rivlin, Large elastic deformations of isotropic materials IV, Phil. Trans. R. Soc. A 241, 1948, with
// the volume split off as in isochoric.h). For small strains it is Hooke's law with the same λ and μ. In
// simple shear γ the shear stress is μ γ, whatever c₀₁; a bar that is stretched by l is pulled with
// 2 (c₁₀ + c₀₁/l)(l − 1/l²) if it is incompressible.
#pragma once

#include <cmath>

#include "lobe/fem/isochoric.h"
#include "lobe/fem/solid.h"
#include "lobe/types.h"

namespace lobe {

template <class T>
struct MooneyRivlinState : IsochoricState<T> {
  using IsochoricState<T>::phi, IsochoricState<T>::slope, IsochoricState<T>::curvature, IsochoricState<T>::v,
      IsochoricState<T>::trace, IsochoricState<T>::K;
  T c1, c2;       // c₁₀, c₀₁ [Pa]
  Mat3<T> other;  // (I₁ − 3) I − (C − I) = I₁ I − C − 2I
  T second;       // I₂ − 3

  LOBE_INLINE MooneyRivlinState(const Mat3<T>& H, const Law<T>& law)
      : IsochoricState<T>(H, law), c1(T(0.5f) * law.mu - law.further[0]), c2(law.further[0]) {
    other = -(H + H.transpose() + H.transpose().lazyProduct(H));
    const T squares = other.cwiseProduct(other).sum();
    for (int i = 0; i < 3; ++i) other(i, i) += trace;
    second = trace + trace + T(0.5f) * (trace * trace - squares);
  }
  LOBE_INLINE T first_weight() const { return (c1 + c1) * phi; }          // 2c₁₀ φ [Pa]
  LOBE_INLINE T second_weight() const { return (c2 + c2) * phi * phi; }   // 2c₀₁ φ²
  LOBE_INLINE T mixed_weight() const { return (c2 + c2) * phi * slope; }  // c₀₁ (φ²)′
  // 2c₁₀ φ + 4c₀₁ φ² + slope of the energy by J.
  LOBE_INLINE T pressure() const {
    return c1 * this->isotropic(trace) + (c2 + c2) * phi * this->isotropic(second) + K * v;
  }
  LOBE_INLINE VolumeDerivatives<T> of_volume() const {
    const T I1 = trace + T(3), I2 = second + T(3);
    return {c1 * slope * I1 + mixed_weight() * I2 + K * v,
            c1 * curvature * I1 + (c2 + c2) * (slope * slope + phi * curvature) * I2 + K};
  }
  // F (I₁ I − C) α, of a = F α.
  LOBE_INLINE Vec3<T> second_slope(const Mat3<T>& H, const Vec3<T>& alpha, const Vec3<T>& a) const {
    const Vec3<T> turned = other.lazyProduct(alpha);
    return a + a + turned + H.lazyProduct(turned);
  }
};

struct MooneyRivlin {  // solid.h
  static constexpr bool in_green_strain = false;
  template <class T>
  LOBE_INLINE static T energy_density(const Mat3<T>& H, const Law<T>& law) {
    const MooneyRivlinState<T> s(H, law);
    const T grown = s.phi - T(1), q1 = s.phi * s.trace + T(3) * grown,
            q2 = s.phi * s.phi * s.second + T(3) * grown * (s.phi + T(1));
    return s.c1 * q1 + s.c2 * q2 + T(0.5f) * s.K * s.v * s.v;
  }
  // With cof F = I + B the parts of F and cof F that are I are summed up without cancellation.
  template <class T>
  LOBE_INLINE static Mat3<T> stress(const Mat3<T>& H, const Law<T>& law) {
    const MooneyRivlinState<T> s(H, law);
    const T second = s.second_weight(), pressure = s.pressure();
    const Mat3<T> turned = s.other * second;
    Mat3<T> P = (H - s.beyond) * (s.first_weight() + second + second) + turned + H.lazyProduct(turned) +
                s.beyond * pressure;
    for (int i = 0; i < 3; ++i) P(i, i) += pressure;
    return P;
  }
  template <class T>
  LOBE_INLINE static void add_second_order(const Mat3<T>& H, const Law<T>& law, SecondOrder<T>& sum) {
    const MooneyRivlinState<T> s(H, law);
    const T second = s.second_weight();
    sum.S += (s.first_weight() + second + second) * Mat3<T>::Identity() + second * s.other;
    sum.psi += s.of_volume();
    sum.has_invariant = true;
    sum.stretch = T(0);
    sum.mixed = T(2) * s.c1 * s.slope;
  }
  // The rest of ∂²I₂/∂u_j∂u_k = 4a_j⊗a_k − 2a_k⊗a_j − 2 (α_j·α_k) F Fᵀ + 2α_j·(I₁ I − C)α_k I, and of that
  // with J.
  template <class T>
  static void add_stiffness(const Mat3<T>& H, const Law<T>& law, const Mat34<T>& alpha,
                            Eigen::Matrix<T, 12, 12>& K) {
    const MooneyRivlinState<T> s(H, law);
    const Mat3<T> F = Mat3<T>::Identity() + H, FF = F * F.transpose();
    const Mat34<T> a = F * alpha, g = cofactor(F) * alpha;
    const T second = s.second_weight(), mixed = T(2) * s.mixed_weight();
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        const Vec3<T> m_j = s.second_slope(H, alpha.col(j), a.col(j)),
                      m_k = s.second_slope(H, alpha.col(k), a.col(k));
        K.template block<3, 3>(3 * j, 3 * k) +=
            second * (T(2) * a.col(j) * a.col(k).transpose() - a.col(k) * a.col(j).transpose() -
                      alpha.col(j).dot(alpha.col(k)) * FF) +
            mixed * (m_j * g.col(k).transpose() + g.col(j) * m_k.transpose());
      }
  }
  template <class T>
  LOBE_INLINE static Mat3<T> diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const Law<T>& law) {
    const MooneyRivlinState<T> s(H, law);
    const Vec3<T> a = alpha + H.lazyProduct(alpha), g = alpha + s.beyond.lazyProduct(alpha),
                  m = s.second_slope(H, alpha, a), turned = s.other.lazyProduct(alpha);
    const VolumeDerivatives<T> psi = s.of_volume();
    const T second = s.second_weight(), squared = alpha.cwiseProduct(alpha).sum();
    const Vec3<T> with_g = a * (T(2) * s.c1 * s.slope) + m * (T(2) * s.mixed_weight());
    Mat3<T> F = H;
    for (int i = 0; i < 3; ++i) F(i, i) += T(1);
    Mat3<T> block = a.lazyProduct((a * second).transpose()) -
                    F.lazyProduct(F.transpose()) * (second * squared) + with_g.lazyProduct(g.transpose()) +
                    g.lazyProduct((with_g + g * psi.curvature).transpose());
    const T shear =
        (s.first_weight() + second + second) * squared + second * alpha.cwiseProduct(turned).sum();
    for (int i = 0; i < 3; ++i) block(i, i) += shear;
    return block;
  }
  static const char* fault(const Law<double>& law) {
    if (law.further[0] >= 0 && 2 * law.further[0] <= law.mu) return "";
    return "mooney_c01 must be at least 0 and at most lame_mu / 2, or else the material does not resist all "
           "changes of shape";
  }
};

}  // namespace lobe
