// Holzapfel, Gasser and Ogden's solid, in place of St Venant-Kirchhoff, for tissue with two families of
// fibres, as the walls of arteries. With the unit vectors a₁, a₂ of the families at rest, J = det F,
// I₁ = tr FᵀF and E_i = |F a_i|² − 1,
//   W/V = μ/2 (J^(−2/3) I₁ − 3) + K/2 (J − 1)² + Σ_i w(max(E_i, 0)),  K = λ + ⅔ μ
//   w   = k₁/(2k₂) (exp(k₂ E²) − 1),  P_i = 2w′ F a_i⊗a_i
// (G. A. Holzapfel, T. C. Gasser, R. W. Ogden, A new constitutive framework for arterial wall mechanics and a
// comparative study of material models, J. Elasticity 61, 2000). Fibres resist no compression. E_i has the
// change of volume in it: without it a swollen fibre would be slack (D. R. Nolan et al., J. Mech. Behav.
// Biomed. Mater. 39, 2014). For small strains without fibres it is Hooke's law with the same λ and μ.
//
// Both families lie at an angle ±θ to the direction m of the tetrahedron, in a plane: a = cos θ m ± sin θ n,
// n the part of a given vector across m. Above k₂ E² = 16, where w′ is 9 million times steeper than at rest,
// w is its Taylor polynomial of degree 2, so that energies are finite.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "lobe/fem/isochoric.h"
#include "lobe/fem/solid.h"
#include "lobe/numerics/simd.h"
#include "lobe/types.h"

namespace lobe {

struct InverseFactorials {
  double of[18];  // 1/0!, 1/1!, 1/2! …
};
inline constexpr InverseFactorials inverse_factorials = [] {
  InverseFactorials values{{1}};
  for (int i = 1; i < 18; ++i) values.of[i] = values.of[i - 1] / i;
  return values;
}();

// exp(x) − 1 for 0 ≤ x ≤ 16, to rounding for small ones and within 1e-14 (single: 1e-5) of exp(x): by a
// polynomial of x/16, then four times exp(2y) − 1 = m (m + 2) of m = exp(y) − 1. It has the same bits for
// every width of registers.
template <class T>
LOBE_INLINE inline T exponential_less_one(const T& x) {
  constexpr int degree = is_single_precision<T> ? 9 : 17;
  const T y = x * T(1.0f / 16);
  T sum = T(inverse_factorials.of[degree]);
  unrolled<degree - 1>([&](int i) LOBE_INLINE { sum = T(inverse_factorials.of[degree - 1 - i]) + sum * y; });
  T m = sum * y;
  unrolled<4>([&](int) LOBE_INLINE { m = m * (m + T(2)); });
  return m;
}

template <class T>
struct FibreStretch {  // one family as it is stretched
  T slope, curvature;  // w′, w″ [Pa]
  T energy;            // w [Pa]

  LOBE_INLINE FibreStretch(const T& E, const Law<T>& law) {
    using std::max, std::min;
    const T k1 = law.further[0], k2 = law.families.stiffening, zero = T(0);
    const T stretched = max(E, zero), e = min(stretched, law.families.most), beyond = stretched - e;
    const T x = k2 * e * e, m = exponential_less_one(x), k = k1 * (T(1) + m);
    const T tiny = T(1e-30f), w = T(0.5f) * k1 * e * e * ((m + tiny) / (x + tiny));
    curvature = k * (T(1) + x + x);
    energy = w + beyond * (k * e + T(0.5f) * curvature * beyond);
    slope = k * e + curvature * beyond;
    const T is_stretched = min(stretched * T(std::numeric_limits<float>::max()), T(1));
    curvature = curvature * is_stretched;
  }
};

template <class T>
struct HolzapfelFibres {
  Vec3<T> m, n;    // the direction, and the one across it in the plane of both families
  Vec3<T> Fm, Fn;  // F m, F n
  T c, s;          // cos θ, sin θ
  FibreStretch<T> one, other;

  LOBE_INLINE HolzapfelFibres(const Mat3<T>& H, const Law<T>& law)
      : m(law.direction),
        n(across(law)),
        Fm(m + H.lazyProduct(m)),
        Fn(n + H.lazyProduct(n)),
        c(law.families.along),
        s(law.families.aside),
        one(stretch(H, T(1)), law),
        other(stretch(H, T(-1)), law) {}

  // Σ 2w′ a⊗a = Mm⊗m + Nn⊗n, as both columns.
  LOBE_INLINE void weights(Vec3<T>& of_m, Vec3<T>& of_n) const {
    const T both = T(2) * (one.slope + other.slope), difference = T(2) * c * s * (one.slope - other.slope);
    of_m = m * (c * c * both) + n * difference;
    of_n = n * (s * s * both) + m * difference;
  }
  LOBE_INLINE Vec3<T> family(int i, const Vec3<T>& along, const Vec3<T>& aside) const {
    return along * c + aside * (i == 0 ? s : -s);
  }

 private:
  LOBE_INLINE static Vec3<T> across(const Law<T>& law) {
    using std::sqrt;
    const Vec3<T> plane(law.families.plane[0], law.families.plane[1], law.families.plane[2]);
    const Vec3<T> part = plane - law.direction * plane.cwiseProduct(law.direction).sum();
    return part * (T(1) / sqrt(T(part.cwiseProduct(part).sum() + T(1e-30f))));
  }
  // |F a|² − 1, free of cancellation.
  LOBE_INLINE T stretch(const Mat3<T>& H, const T& sign) const {
    const Vec3<T> a = m * c + n * (s * sign), Ha = H.lazyProduct(a);
    return Ha.cwiseProduct(a + a + Ha).sum();
  }
};

struct Holzapfel {  // solid.h
  static constexpr bool in_green_strain = false;
  template <class T>
  LOBE_INLINE static T energy_density(const Mat3<T>& H, const Law<T>& law) {
    const IsochoricState<T> s(H, law);
    const HolzapfelFibres<T> fibres(H, law);
    const T q = s.phi * s.trace + T(3) * (s.phi - T(1));
    return T(0.5f) * (law.mu * q + s.K * s.v * s.v) + (fibres.one.energy + fibres.other.energy);
  }
  template <class T>
  LOBE_INLINE static Mat3<T> stress(const Mat3<T>& H, const Law<T>& law) {
    const IsochoricState<T> s(H, law);
    const HolzapfelFibres<T> fibres(H, law);
    const T pressure = T(0.5f) * law.mu * s.isotropic(s.trace) + s.K * s.v;
    Vec3<T> of_m, of_n;
    fibres.weights(of_m, of_n);
    Mat3<T> P = (H - s.beyond) * (law.mu * s.phi) + s.beyond * pressure;
    for (int j = 0; j < 3; ++j) P.col(j) += fibres.Fm * of_m[j] + fibres.Fn * of_n[j];
    for (int i = 0; i < 3; ++i) P(i, i) += pressure;
    return P;
  }
  template <class T>
  LOBE_INLINE static void add_second_order(const Mat3<T>& H, const Law<T>& law, SecondOrder<T>& sum) {
    const IsochoricState<T> s(H, law);
    const HolzapfelFibres<T> fibres(H, law);
    Vec3<T> of_m, of_n;
    fibres.weights(of_m, of_n);
    sum.S += law.mu * s.phi * Mat3<T>::Identity() + of_m * fibres.m.transpose() + of_n * fibres.n.transpose();
    const T half = T(0.5f) * law.mu;
    sum.psi += VolumeDerivatives<T>{half * s.slope_of_trace() + s.K * s.v,
                                    half * s.curvature * (s.trace + T(3)) + s.K};
    sum.has_invariant = true;
    sum.stretch = T(0);
    sum.mixed = law.mu * s.slope;
  }
  // Σ 4w″ (a·α_j)(a·α_k) F a⊗F a; that of w′ is in S.
  template <class T>
  static void add_stiffness(const Mat3<T>& H, const Law<T>& law, const Mat34<T>& alpha,
                            Eigen::Matrix<T, 12, 12>& K) {
    const HolzapfelFibres<T> fibres(H, law);
    for (int i = 0; i < 2; ++i) {
      const Vec3<T> a = fibres.family(i, fibres.m, fibres.n), Fa = fibres.family(i, fibres.Fm, fibres.Fn);
      Eigen::Matrix<T, 12, 1> slope;
      for (int j = 0; j < 4; ++j) slope.template segment<3>(3 * j) = Fa * a.dot(alpha.col(j));
      K += T(4) * (i == 0 ? fibres.one : fibres.other).curvature * slope * slope.transpose();
    }
  }
  template <class T>
  LOBE_INLINE static Mat3<T> diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const Law<T>& law) {
    const IsochoricState<T> s(H, law);
    const HolzapfelFibres<T> fibres(H, law);
    Vec3<T> of_m, of_n;
    fibres.weights(of_m, of_n);
    const Vec3<T> a = alpha + H.lazyProduct(alpha), g = alpha + s.beyond.lazyProduct(alpha);
    const T bulk = T(0.5f) * law.mu * s.curvature * (s.trace + T(3)) + s.K;
    const Vec3<T> with_g = a * (law.mu * s.slope);
    Mat3<T> block = with_g.lazyProduct(g.transpose()) + g.lazyProduct((with_g + g * bulk).transpose());
    for (int i = 0; i < 2; ++i) {
      const Vec3<T> Fa = fibres.family(i, fibres.Fm, fibres.Fn);
      const T p = fibres.family(i, fibres.m, fibres.n).cwiseProduct(alpha).sum();
      const T stiffness = T(4) * p * p * (i == 0 ? fibres.one : fibres.other).curvature;
      block += Fa.lazyProduct((Fa * stiffness).transpose());
    }
    const T shear = law.mu * s.phi * alpha.cwiseProduct(alpha).sum() +
                    of_m.cwiseProduct(alpha).sum() * fibres.m.cwiseProduct(alpha).sum() +
                    of_n.cwiseProduct(alpha).sum() * fibres.n.cwiseProduct(alpha).sum();
    for (int i = 0; i < 3; ++i) block(i, i) += shear;
    return block;
  }
  static const char* fault(const Law<double>& law) {
    const auto& families = law.families;
    if (!(law.further[0] > 0 && std::isfinite(law.further[0])))
      return "holzapfel_k1 must be above 0: it is the stiffness of the fibres";
    if (!(families.stiffening >= 0 && std::isfinite(families.stiffening)))
      return "holzapfel_k2 must be at least 0";
    if (!(families.aside >= 0 && families.along >= -1e-12))
      return "holzapfel_angle must be from 0 to 90 degrees";
    const double squared = families.plane[0] * families.plane[0] + families.plane[1] * families.plane[1] +
                           families.plane[2] * families.plane[2];
    if (families.aside > 0 && !(squared > 0 && std::isfinite(squared)))
      return "holzapfel_plane is missing: a vector, other than the direction, of the plane of both families";
    return "";
  }
};

}  // namespace lobe
