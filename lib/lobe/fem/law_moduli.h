// The data of a law: which terms the energy of a tetrahedron has, and their moduli. law.h has the formulas,
// so that what only stores or passes on a law is not compiled again when a formula changes.
#pragma once

#include <array>
#include <cstdint>
#include <iterator>
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

// Both families of fibres of Holzapfel's law (fem/holzapfel.h), but for k₁.
template <class T>
struct FibreFamilies {
  T stiffening{};            // k₂
  T most{};                  // the stretch E up to which stress grows exponentially
  T along{1}, aside{};       // cos and sin of the angle between each of them and the direction
  std::array<T, 3> plane{};  // any vector of their plane that is not the direction

  template <class U>
  FibreFamilies<U> as() const {
    return {U(stiffening), U(most), U(along), U(aside), {U(plane[0]), U(plane[1]), U(plane[2])}};
  }
};

// The laws of the non-linear model. A new one has a row here, and a struct of formulas in law.h. Then that of
// corotational regions, which no material names; and `none`, a sum of other terms alone.
enum class MaterialLaw : std::uint8_t {
  svk,
  neo_hookean,
  yeoh,
  mooney_rivlin,
  holzapfel,
  corotational,
  none
};
struct LawRow {
  const char* name;                 // name in scenes
  std::array<const char*, 2> keys;  // names of its constants beside λ and μ in scenes; null: it has fewer
  std::size_t moduli = 2;           // number of constants that are in Pa; the others have no unit
};
inline constexpr LawRow law_rows[] = {{"svk", {}},
                                      {"neo-hookean", {}},
                                      {"yeoh", {"yeoh_c2", "yeoh_c3"}},
                                      {"mooney-rivlin", {"mooney_c01"}},
                                      {"holzapfel", {"holzapfel_k1", "holzapfel_k2"}, 1}};
inline constexpr int law_count = std::size(law_rows);
static_assert(law_count == int(MaterialLaw::corotational));
inline constexpr int solid_count = int(MaterialLaw::none);
[[gnu::always_inline]] constexpr bool has_families(MaterialLaw law) { return law == MaterialLaw::holzapfel; }
// Which strain of volume nodal pressure averages: tr E of St Venant-Kirchhoff, J − 1 of all others.
[[gnu::always_inline]] constexpr bool averages_green_strain(MaterialLaw law) {
  return law == MaterialLaw::svk || law == MaterialLaw::none;
}

struct Terms {
  MaterialLaw solid = MaterialLaw::svk;
  bool volume = false, pressure = false, guard = false, fibre = false;

  bool operator==(const Terms&) const = default;
  [[gnu::always_inline]] constexpr bool has_direction() const { return fibre || has_families(solid); }
  constexpr bool includes(const Terms& other) const {
    return (solid == other.solid || other.solid == MaterialLaw::none) && volume >= other.volume &&
           pressure >= other.pressure && guard >= other.guard && fibre >= other.fibre;
  }
  // The same without the terms that any solid may have besides its own: volume, pressure, guard.
  constexpr Terms without_additions() const {
    Terms own = *this;
    own.volume = own.pressure = own.guard = false;
    return own;
  }
};

template <class T>
struct Law {
  T lambda, mu;       // λ without the share that nodal pressure takes over [Pa]
  T kappa;            // volume penalty [Pa]
  T pressure;         // mean nodal pressure p_T of the tetrahedron [Pa]
  T guard_modulus;    // M [Pa]
  T guard_threshold;  // J₀
  Terms terms;
  FibreModuli<T> fibre{};
  Vec3<T> direction{};         // direction of the fibre, a unit vector at rest; not read without the term
  std::array<T, 2> further{};  // moduli of the solid beside λ and μ (law_rows) [Pa]
  FibreFamilies<T> families{};

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
            {U(direction[0]), U(direction[1]), U(direction[2])},
            {U(further[0]), U(further[1])},
            families.template as<U>()};
  }
  Law times(const T& V) const {  // all moduli: energies and stresses are then V times those of this law
    return {V * lambda,      V * mu, V * kappa,      V * pressure, V * guard_modulus,
            guard_threshold, terms,  fibre.times(V), direction,    {V * further[0], V * further[1]},
            families};
  }
};

}  // namespace lobe
