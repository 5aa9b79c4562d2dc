// Yeoh's solid, in place of St Venant-Kirchhoff, for tissue that stiffens with its stretch: with J = det F,
// I₁ = tr FᵀF and q = J^(−2/3) I₁ − 3, which a mere change of volume leaves at 0,
//   W/V = w(q) + K/2 (J − 1)²,  w = μ/2 q + c₂ q² + c₃ q³,  K = λ + ⅔ μ
//   P   = 2w′ φ F + (w′ φ′ I₁ + K (J − 1)) cof F,  φ = J^(−2/3)
// (O. H. Yeoh, Some forms of the strain energy function for rubber, Rubber Chem. Technol. 66, 1993). For
// small strains it is Hooke's law with the same λ and μ. In simple shear γ the shear stress is 2 w′(γ²) γ.
#pragma once

#include <cmath>

#include "lobe/fem/isochoric.h"
#include "lobe/fem/solid.h"
#include "lobe/types.h"

namespace lobe {

template <class T>
struct YeohState : IsochoricState<T> {
  T isotropic;  // 2φ + φ′ I₁
  T w1, w2;     // w′, w″ [Pa]
  T energy;     // w [Pa]

  LOBE_INLINE YeohState(const Mat3<T>& H, const Law<T>& law)
      : IsochoricState<T>(H, law), isotropic(IsochoricState<T>::isotropic(this->trace)) {
    const T q = this->phi * this->trace + T(3) * (this->phi - T(1));
    const T c2 = law.further[0], c3 = law.further[1];
    energy = q * (T(0.5f) * law.mu + q * (c2 + q * c3));
    w1 = T(0.5f) * law.mu + q * (c2 + c2 + T(3) * c3 * q);
    w2 = c2 + c2 + T(6) * c3 * q;
  }
};

struct Yeoh {  // solid.h
  static constexpr bool in_green_strain = false;
  template <class T>
  LOBE_INLINE static T energy_density(const Mat3<T>& H, const Law<T>& law) {
    const YeohState<T> s(H, law);
    return s.energy + T(0.5f) * s.K * s.v * s.v;
  }
  template <class T>
  LOBE_INLINE static Mat3<T> stress(const Mat3<T>& H, const Law<T>& law) {
    const YeohState<T> s(H, law);
    const T pressure = s.w1 * s.isotropic + s.K * s.v;
    Mat3<T> P = (H - s.beyond) * ((s.w1 + s.w1) * s.phi) + s.beyond * pressure;
    for (int i = 0; i < 3; ++i) P(i, i) += pressure;
    return P;
  }
  template <class T>
  LOBE_INLINE static void add_second_order(const Mat3<T>& H, const Law<T>& law, SecondOrder<T>& sum) {
    const YeohState<T> s(H, law);
    const T slope = s.slope_of_trace(), two = T(2);
    sum.S += two * s.w1 * s.phi * Mat3<T>::Identity();
    sum.psi += VolumeDerivatives<T>{s.w1 * slope + s.K * s.v,
                                    s.w2 * slope * slope + s.w1 * s.curvature * (s.trace + T(3)) + s.K};
    sum.has_invariant = true;
    sum.stretch = T(4) * s.w2 * s.phi * s.phi;
    sum.mixed = two * (s.w2 * s.phi * slope + s.w1 * s.slope);
  }
  // 2w′φ (α·α) I + 4w″φ² a⊗a + 2 (w″ φ φ′I₁ + w′φ′)(a⊗g + g⊗a) + ψ″ g⊗g with a = F α, g = cof(F) α.
  template <class T>
  LOBE_INLINE static Mat3<T> diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const Law<T>& law) {
    const YeohState<T> s(H, law);
    const T slope = s.slope_of_trace();
    const Vec3<T> a = alpha + H.lazyProduct(alpha), g = alpha + s.beyond.lazyProduct(alpha);
    const T mixed = s.w2 * s.phi * slope + s.w1 * s.slope;
    const T bulk = s.w2 * slope * slope + s.w1 * s.curvature * (s.trace + T(3)) + s.K;
    const Vec3<T> with_a = a * (T(4) * s.w2 * s.phi * s.phi) + g * (mixed + mixed),
                  with_g = a * (mixed + mixed) + g * bulk;
    Mat3<T> block = a.lazyProduct(with_a.transpose()) + g.lazyProduct(with_g.transpose());
    const T shear = (s.w1 + s.w1) * s.phi * alpha.cwiseProduct(alpha).sum();
    for (int i = 0; i < 3; ++i) block(i, i) += shear;
    return block;
  }
  // w′ > 0 for every q ≥ 0.
  static const char* fault(const Law<double>& law) {
    const double c2 = law.further[0], c3 = law.further[1];
    if (std::isfinite(c2) && std::isfinite(c3) && c3 >= 0 && (c2 >= 0 || 4 * c2 * c2 < 6 * c3 * law.mu))
      return "";
    return "yeoh_c3 must be at least 0, and yeoh_c2 above -sqrt(1.5 * yeoh_c3 * lame_mu), or else the "
           "material does not resist large stretches";
  }
};

}  // namespace lobe
