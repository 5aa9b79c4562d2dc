// Linear elasticity in the frame of each tetrahedron's rotation (polar_rotation.h): with F = R S, ε = S − I,
//   W/V = λ/2 (tr ε)² + μ ε:ε
//   P   = R (λ tr ε I + 2μ ε)
//   ∂²W/∂u_j∂u_k / V = R (2μ (α_j·α_k) I + λ α_j⊗α_k + c [α_j]ᵀ G⁻¹ [α_k]) Rᵀ,
//     c = λ tr ε − 2μ,  G = tr(S) I − S,  [α] v = α × v
// (E. Sifakis, J. Barbič, FEM simulation of 3D deformable solids, SIGGRAPH courses, 2012, section 3.4, where
// the terms are λ/2 tr²(RᵀF − I) and μ |F − R|²). P is all of the energy's derivative, since S commutes with
// the stress of a solid that is alike in all directions. The third term of the tangent is the share of dR,
// where dR = R [ω] and G ω is the axis of RᵀdF − dFᵀR. So balances of energy and the step limit are exact.
// They are not if forces are those of a rotated linear stiffness.
//
// For small strains it is Hooke's law, however far a tetrahedron turns. R is a rotation for every F, so all
// is finite where det F ≤ 0 too, and an inverted tetrahedron is pushed back: its smallest stretch s₃ < 0 is
// to become 1. Where s₂ + s₃ = 0, two rotations are as near, and the energy has a ridge between them. The
// stiffness has no bound there; it is computed with det G of at least `least_det` (8 at rest).
#pragma once

#include "lobe/fem/polar_rotation.h"
#include "lobe/fem/solid.h"
#include "lobe/fem/svk.h"

namespace lobe {

template <class T>
struct CorotationalState {
  Mat3<T> R, strain;  // ε
  T trace;            // tr ε

  LOBE_INLINE explicit CorotationalState(const Mat3<T>& H) {
    Mat3<T> F = H;
    for (int i = 0; i < 3; ++i) F(i, i) += T(1);
    R = polar_rotation(F);
    // RᵀF − I has the rounding errors of R. As (I + ε)² = FᵀF, ε = E − ½ ε² with Green's strain E has errors
    // relative to H.
    Mat3<T> rough = R.transpose().lazyProduct(F);
    rough = (rough + rough.transpose().eval()) * T(0.5f);
    for (int i = 0; i < 3; ++i) rough(i, i) -= T(1);
    strain = green_strain(H) - rough.lazyProduct(rough) * T(0.5f);
    trace = strain(0, 0) + strain(1, 1) + strain(2, 2);
  }
};

// R and G⁻¹ of the rotation's share in the stiffness.
template <class T>
struct CorotationalFrame {
  static constexpr float least_det = 1e-3f;
  CorotationalState<T> state;
  Mat3<T> inverse;  // G⁻¹
  T c;              // [Pa]

  LOBE_INLINE CorotationalFrame(const Mat3<T>& H, const Law<T>& law) : state(H) {
    using std::max;
    Mat3<T> G = -state.strain;
    for (int i = 0; i < 3; ++i) G(i, i) += state.trace + T(2);
    const Mat3<T> adjugate = cofactor(G);  // G is symmetric
    const T det = G(0, 0) * adjugate(0, 0) + G(1, 0) * adjugate(1, 0) + G(2, 0) * adjugate(2, 0);
    inverse = adjugate * (T(1) / max(det, T(least_det)));
    c = law.lambda * state.trace - (law.mu + law.mu);
  }
  // The block of two corners with gradients a = α_j, b = α_k.
  LOBE_INLINE Mat3<T> block(const Vec3<T>& a, const Vec3<T>& b, const Law<T>& law) const {
    const Mat3<T> turned = cross_matrix(a).transpose().lazyProduct(inverse.lazyProduct(cross_matrix(b)));
    Mat3<T> K = a.lazyProduct(b.transpose()) * law.lambda + turned * c;
    const T shear = (law.mu + law.mu) * a.cwiseProduct(b).sum();
    for (int i = 0; i < 3; ++i) K(i, i) += shear;
    return state.R.lazyProduct(K.lazyProduct(state.R.transpose()));
  }
};

struct Corotational {  // solid.h
  static constexpr bool in_green_strain = false;
  template <class T>
  LOBE_INLINE static T energy_density(const Mat3<T>& H, const Law<T>& law) {
    const CorotationalState<T> s(H);
    return T(0.5f) * law.lambda * s.trace * s.trace + law.mu * s.strain.cwiseProduct(s.strain).sum();
  }
  template <class T>
  LOBE_INLINE static Mat3<T> stress(const Mat3<T>& H, const Law<T>& law) {
    const CorotationalState<T> s(H);
    Mat3<T> stress = s.strain * (law.mu + law.mu);
    const T pressure = law.lambda * s.trace;
    for (int i = 0; i < 3; ++i) stress(i, i) += pressure;
    return s.R.lazyProduct(stress);
  }
  template <class T>
  LOBE_INLINE static Mat3<T> diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const Law<T>& law) {
    return CorotationalFrame<T>(H, law).block(alpha, alpha, law);
  }
  template <class T>
  static void add_stiffness(const Mat3<T>& H, const Law<T>& law, const Mat34<T>& alpha,
                            Eigen::Matrix<T, 12, 12>& K) {
    const CorotationalFrame<T> frame(H, law);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k)
        K.template block<3, 3>(3 * j, 3 * k) +=
            frame.block(Vec3<T>(alpha.col(j)), Vec3<T>(alpha.col(k)), law);
  }
  template <class T>
  LOBE_INLINE static void add_second_order(const Mat3<T>&, const Law<T>&, SecondOrder<T>&) {}
  static const char* fault(const Law<double>&) { return ""; }
};

}  // namespace lobe
