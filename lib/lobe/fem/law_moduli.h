// The data of a law: which terms the energy of a tetrahedron has, and their moduli. law.h has the formulas,
// so that what only stores or passes on a law is not compiled again when a formula changes.
#pragma once

#include <tuple>

#include "lobe/types.h"

namespace lobe {

template <class T>
struct FibreModuli {
  T coupling{};  // ε = C_LT − λ [Pa]
  T shear{};     // η = G_LT − μ [Pa]
  T stretch{};   // β [Pa]

  bool any() const { return coupling != 0 || shear != 0 || stretch != 0; }
  FibreModuli times(const T& V) const { return {V * coupling, V * shear, V * stretch}; }
  FibreModuli& operator+=(const FibreModuli& other) {
    coupling += other.coupling;
    shear += other.shear;
    stretch += other.stretch;
    return *this;
  }
  template <class U>
  FibreModuli<U> as() const {
    return {U(coupling), U(shear), U(stretch)};
  }
  static constexpr auto fields =
      std::tuple(&FibreModuli::coupling, &FibreModuli::shear, &FibreModuli::stretch);
};

struct Terms {
  bool svk = true, volume = false, pressure = false, guard = false, fibre = false, neo_hookean = false;

  bool operator==(const Terms&) const = default;
  constexpr bool includes(const Terms& other) const {
    return svk >= other.svk && volume >= other.volume && pressure >= other.pressure && guard >= other.guard &&
           fibre >= other.fibre && neo_hookean >= other.neo_hookean;
  }
  // Without those that any solid may have, whose moduli are 0 where it has not.
  constexpr Terms solid() const {
    Terms own = *this;
    own.volume = own.pressure = own.guard = false;
    return own;
  }
};

template <class T>
struct Law {
  T lambda, mu;       // λ without the share that nodal pressure takes over [Pa]
  T kappa;            // volume penalty [Pa]
  T pressure;         // of nodal pressure, mean p_T of the tetrahedron [Pa]
  T guard_modulus;    // M [Pa]
  T guard_threshold;  // J₀
  Terms terms;
  FibreModuli<T> fibre{};
  Vec3<T> direction{};  // of the fibre, a unit vector at rest; not read without the term

  template <class U>
  Law<U> as() const {
    return {U(lambda),
            U(mu),
            U(kappa),
            U(pressure),
            U(guard_modulus),
            U(guard_threshold),
            terms,
            fibre.template as<U>(),
            {U(direction[0]), U(direction[1]), U(direction[2])}};
  }
  Law times(const T& V) const {  // all moduli: energies and stresses are then V times those of this law
    return {V * lambda,      V * mu, V * kappa,      V * pressure, V * guard_modulus,
            guard_threshold, terms,  fibre.times(V), direction};
  }
};

}  // namespace lobe
