// Resistance to collapse: an energy of J = det F that is exactly zero while J ≥ J₀, the threshold `below`,
// and rises steeply under it. With t = (J₀ − J)/J₀ and the element's modulus M = λ + 2μ,
//   W = V M J₀² w(t),  w = 0 for t ≤ 0,  w = t³/(1 − t) up to t = ¾,
// then the quadratic with the same value, slope and curvature. It grows without bound as J → −∞, so an
// inverted element is pushed back more the further it is inverted. It is twice continuously differentiable.
// It depends only on F, so it conserves momentum. Rotations do not change it. dw/dF = −w' cof F / J₀.
//
// The rational branch alone would be infinite at J = 0, where no explicit step could follow it, and a start
// beyond would stay inverted. It ends at J₀/4, so that the curvature is at most 126 M. That limits by how
// much a guarded element shortens the time step. A force that flattens an element (J = 0) must exceed 45 M J₀
// per area.
#pragma once

#include <algorithm>

#include "lobe/fem/volume_term.h"

namespace lobe {

template <class T>
struct Guard {  // W/V and its first two derivatives by J, all in units of M
  T energy, slope, curvature;
};

template <class T>
Guard<T> guard(const T& J, const T& below)  // J₀ > 0
{
  using std::max, std::min;
  const T t = max(T(0), T(1) - J / below), r = min(t, T(0.75f));
  const T s = T(1) / (T(1) - r), q = r * s, beyond = t - r;
  const T w = r * r * q, slope = q * q * (T(3) - r - r), curvature = q * (T(6) + q * (T(6) + q + q));
  return {below * below * (w + beyond * (slope + T(0.5f) * beyond * curvature)),
          -below * (slope + beyond * curvature), curvature};
}

template <class T>
T guard_energy_density(const Mat3<T>& H, const T& modulus, const T& below)  // [Pa] → [J/m³]
{
  return modulus * guard(T(T(1) + volume_change(H)), below).energy;
}

template <class T>
Mat3<T> guard_stress(const Mat3<T>& H, const T& modulus,
                     const T& below)  // adds to the first Piola-Kirchhoff stress [Pa]
{
  return deformation_cofactor(H) * (modulus * guard(T(T(1) + volume_change(H)), below).slope);
}

template <class T>
VolumeDerivatives<T> guard_derivatives(const Mat3<T>& H, const T& modulus, const T& below)  // [Pa]
{
  const Guard<T> held = guard(T(T(1) + volume_change(H)), below);
  return {modulus * held.slope, modulus * held.curvature};
}

// ∂²W/∂u_j² / V = M w'' g⊗g / J₀², g = cof(F) α_j, as for the volume term.
template <class T>
Mat3<T> guard_diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha, const T& modulus,
                             const T& below)  // [Pa/m²]
{
  const Vec3<T> g = deformation_cofactor(H).lazyProduct(alpha);
  const T scale = modulus * guard(T(T(1) + volume_change(H)), below).curvature;
  return g.lazyProduct(g.transpose()) * scale;
}

}  // namespace lobe
