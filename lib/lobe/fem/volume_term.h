// Resistance to change of volume, [PDA] section 4 with erratum 4. The printed force has no sign and conserves
// no momentum. This is the energy behind it, W = κ V |v|³/3 with v = (V_now − V)/V = det F − 1 (θ in the
// theory). The force on corner j is −κ v|v| ∂V_now/∂x_j. Since ∂v/∂F = cof F, the term adds κ v|v| cof F to
// P.
#pragma once

#include <cmath>

#include "lobe/types.h"

namespace lobe {

template <class T>
Mat3<T> cofactor(const Mat3<T>& A) {
  Mat3<T> C;
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    for (int i = 0; i < 3; ++i) {
      const int m = (i + 1) % 3, n = (i + 2) % 3;
      C(i, j) = A(m, k) * A(n, l) - A(m, l) * A(n, k);
    }
  }
  return C;
}

// v = det(I + H) − 1 = tr H + (principal minors of H) + det H, free of cancellation for small H.
template <class T>
T volume_change(const Mat3<T>& H) {
  const T minors = H(0, 0) * H(1, 1) - H(0, 1) * H(1, 0) + H(1, 1) * H(2, 2) - H(1, 2) * H(2, 1) +
                   H(0, 0) * H(2, 2) - H(0, 2) * H(2, 0);
  const T det = H(0, 0) * (H(1, 1) * H(2, 2) - H(1, 2) * H(2, 1)) -
                H(0, 1) * (H(1, 0) * H(2, 2) - H(1, 2) * H(2, 0)) +
                H(0, 2) * (H(1, 0) * H(2, 1) - H(1, 1) * H(2, 0));
  return H(0, 0) + H(1, 1) + H(2, 2) + minors + det;
}

// det(I + H) at half the cost, with rounding errors of the size of its terms. It is good enough to tell what
// is near collapse.
template <class T>
T volume_ratio(const Mat3<T>& H) {
  const T a = T(1) + H(0, 0), b = T(1) + H(1, 1), c = T(1) + H(2, 2);
  return a * (b * c - H(1, 2) * H(2, 1)) - H(0, 1) * (H(1, 0) * c - H(1, 2) * H(2, 0)) +
         H(0, 2) * (H(1, 0) * H(2, 1) - b * H(2, 0));
}

template <class T>
Mat3<T> deformation_cofactor(const Mat3<T>& H)  // cof F = ∂ det F/∂F
{
  Mat3<T> F = H;
  for (int i = 0; i < 3; ++i) F(i, i) += T(1);
  return cofactor(F);
}

template <class T>
T volume_energy_density(const Mat3<T>& H, const T& kappa)  // [Pa] → [J/m³]
{
  using std::abs;
  const T v = abs(volume_change(H));
  return kappa * v * v * v / T(3);
}

template <class T>
Mat3<T> volume_stress(const Mat3<T>& H, const T& kappa)  // adds to the first Piola-Kirchhoff stress [Pa]
{
  using std::abs;
  const T v = volume_change(H);
  return deformation_cofactor(H) * (kappa * v * abs(v));
}

template <class T>
struct VolumeDerivatives {  // W/V's derivatives by J = det F, of a term that depends on J only [Pa]
  T slope, curvature;

  void operator+=(const VolumeDerivatives& other) {
    slope += other.slope;
    curvature += other.curvature;
  }
};

template <class T>
VolumeDerivatives<T> volume_derivatives(const Mat3<T>& H, const T& kappa) {
  using std::abs;
  const T v = volume_change(H);
  return {kappa * v * abs(v), T(2) * kappa * abs(v)};
}

// ∂²W/∂u_j² / V = 2κ|v| g⊗g with g = cof(F) α_j (det F is linear in each vertex).
template <class T>
Mat3<T> volume_diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const T& kappa)  // [Pa/m²]
{
  using std::abs;
  const Vec3<T> g = deformation_cofactor(H).lazyProduct(alpha);
  const T scale = T(2) * kappa * abs(volume_change(H));
  return g.lazyProduct(g.transpose()) * scale;
}

}  // namespace lobe
