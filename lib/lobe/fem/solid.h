// What the formulas of a law of the non-linear model have: a struct `Solid` of static functions of the
// displacement gradient H and the moduli of a Law.
//   in_green_strain                 whether the energy is a function of Green's strain by which fibres add up
//   energy_density, stress          W/V [J/m³], P [Pa]
//   diagonal_block                  ∂²W/∂u_j² / V of a corner with gradient α [Pa/m²]
//   add_second_order                adds what law_stiffness() needs
//   add_stiffness                   adds ∂²W/∂u_j∂u_k / V, if that has another form
//   fault                           says which moduli make no solid; empty: they do
// With in_green_strain also second_stress, S [Pa], and green_block, B_jk [Pa/m²].
#pragma once

#include "lobe/fem/law_moduli.h"
#include "lobe/fem/volume_term.h"
#include "lobe/types.h"

#define LOBE_INLINE __attribute__((always_inline))

namespace lobe {

template <class T>
Mat3<T> cross_matrix(const Vec3<T>& a)  // a × …
{
  Mat3<T> A;
  A << T(0), -a.z(), a.y(), a.z(), T(0), -a.x(), -a.y(), a.x(), T(0);
  return A;
}

// A sum that begins with the first term. To add it to 0 would cost time and change the sign of a zero.
template <class Value>
class SumOfTerms {
 public:
  explicit SumOfTerms(const Value& zero) : sum_(zero) {}
  void operator+=(const Value& term) {
    if (empty_)
      sum_ = term;
    else
      sum_ += term;
    empty_ = false;
  }
  const Value& value() const { return sum_; }

 private:
  Value sum_;
  bool empty_ = true;
};

// The sums of a law's terms in its stiffness (law.h).
template <class T>
struct SecondOrder {
  SumOfTerms<Mat3<T>> S{Mat3<T>::Zero()};              // [Pa]
  SumOfTerms<VolumeDerivatives<T>> psi{{T(0), T(0)}};  // derivatives of functions of J [Pa]
  bool has_invariant = false;                          // a solid has set the two below
  T stretch{}, mixed{};                                // 4 ∂²W/∂I₁², 2 ∂²W/∂I₁∂J [Pa]
};

}  // namespace lobe
