// The sums of terms of a law for which wide kernels are compiled. Each law of fem/law_moduli.h has its own; a
// law with other terms needs an entry.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

#include "lobe/fem/law_moduli.h"

namespace lobe {

// Sums of St Venant-Kirchhoff, then those of each other law, whose fibres are its own, then a last one.
template <std::size_t own, std::size_t each>
constexpr auto with_each_law(const Terms (&of_svk)[own], const Terms (&of_each)[each], const Terms& last) {
  std::array<Terms, own + (law_count - 1) * each + 1> all;
  auto next = std::copy(std::begin(of_svk), std::end(of_svk), all.begin());
  for (int law = 1 + int(MaterialLaw::svk); law < law_count; ++law)
    for (Terms terms : of_each) {
      terms.solid = MaterialLaw(law);
      *next++ = terms;
    }
  *next = last;
  return all;
}

// A patch takes the first entry that covers its law.
inline constexpr auto compiled_terms = with_each_law(
    {{},
     {.volume = true},
     {.pressure = true},
     {.fibre = true},
     {.volume = true, .fibre = true},
     {.volume = true, .pressure = true, .fibre = true},
     {.solid = MaterialLaw::corotational}},
    {{}, {.volume = true}, {.volume = true, .pressure = true}}, {.volume = true, .pressure = true});
// Sums of finite strain in smoothed patches. The first is that of forces alone. Those of small strain are
// compiled with and without fibres.
inline constexpr auto smoothed_terms =
    with_each_law({{}, {.pressure = true}, {.pressure = true, .fibre = true}}, {{}, {.pressure = true}},
                  {.solid = MaterialLaw::corotational});

// Terms for tetrahedra, and below for domains, whose material has a Prony series (viscous_kernels.h).
inline constexpr auto viscous_terms =
    with_each_law({{}, {.volume = true, .pressure = true}, {.volume = true, .pressure = true, .fibre = true}},
                  {{.volume = true, .pressure = true}}, {.solid = MaterialLaw::corotational});
// The fibre of a kernel is read: only a law that has one takes such a kernel.
inline constexpr auto viscous_domain_terms =
    with_each_law({{}, {.pressure = true}, {.pressure = true, .fibre = true}}, {{.pressure = true}},
                  {.solid = MaterialLaw::corotational});

// Whether a kernel for these terms can evaluate the law: it is one of the same solid, with at least its other
// terms. What the law does not have gets the modulus 0. The guard may be in every kernel.
constexpr bool covers(const Terms& compiled, Terms of_law) {
  of_law.guard = false;
  return compiled.without_additions() == of_law.without_additions() && compiled.includes(of_law);
}
inline bool is_covered(const Terms& of_law) {
  return std::any_of(compiled_terms.begin(), compiled_terms.end(),
                     [&](const Terms& compiled) { return covers(compiled, of_law); });
}

}  // namespace lobe
