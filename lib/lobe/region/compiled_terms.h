// The sums of terms of a law for which wide kernels are compiled. A law with other terms needs an entry.
#pragma once

#include <algorithm>
#include <iterator>

#include "lobe/fem/law_moduli.h"

namespace lobe {

constexpr Terms averaged(MaterialLaw law) { return {.solid = law, .volume = true, .pressure = true}; }

// A patch takes the first entry that covers its law.
inline constexpr Terms compiled_terms[] = {{},
                                           {.volume = true},
                                           {.pressure = true},
                                           {.fibre = true},
                                           {.volume = true, .fibre = true},
                                           {.volume = true, .pressure = true, .fibre = true},
                                           {.solid = MaterialLaw::neo_hookean},
                                           {.solid = MaterialLaw::neo_hookean, .volume = true},
                                           {.solid = MaterialLaw::yeoh},
                                           {.solid = MaterialLaw::yeoh, .volume = true},
                                           {.solid = MaterialLaw::mooney_rivlin},
                                           {.solid = MaterialLaw::mooney_rivlin, .volume = true},
                                           {.solid = MaterialLaw::holzapfel},
                                           {.solid = MaterialLaw::holzapfel, .volume = true},
                                           averaged(MaterialLaw::neo_hookean),
                                           averaged(MaterialLaw::yeoh),
                                           averaged(MaterialLaw::mooney_rivlin),
                                           averaged(MaterialLaw::holzapfel),
                                           {.solid = MaterialLaw::corotational},
                                           {.volume = true, .pressure = true}};

// Whether a kernel for these terms can evaluate the law: it is one of the same solid, with at least its other
// terms. What the law does not have gets the modulus 0. The guard may be in every kernel.
constexpr bool covers(const Terms& compiled, Terms of_law) {
  of_law.guard = false;
  return compiled.without_additions() == of_law.without_additions() && compiled.includes(of_law);
}
inline bool is_covered(const Terms& of_law) {
  return std::any_of(std::begin(compiled_terms), std::end(compiled_terms),
                     [&](const Terms& compiled) { return covers(compiled, of_law); });
}

}  // namespace lobe
