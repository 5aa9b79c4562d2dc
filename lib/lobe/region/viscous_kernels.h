// The wide kernels of tetrahedra and smoothing domains whose material has a Prony series (fem/prony.h), and
// the strains of dashpots that they read and write. They are others than those of elastic materials, which
// so pay nothing.
#pragma once

#include <iterator>

#include "lobe/fem/prony.h"
#include "lobe/region/smoothed_kernels.h"

namespace lobe {

// A of one term, of as many tetrahedra or domains as a block has.
template <class Real>
struct alignas(64) DashpotStrains {
  std::array<typename ElementBlock<Real>::Row, 6> A{};  // xx, yy, zz, xy, xz, yz
};

template <class Real>
struct Branch {
  Real lambda{}, two_mu{};  // λ_i, 2μ_i [Pa]
  Real before{};            // exp(−t/τ_i), t from the time of A to that of the displacements
  Real over{};              // of the whole time until A is found again
};

template <class Real>
struct ViscousArrays {            // of one patch
  DashpotStrains<Real>* strains;  // `terms` for each block, one after the other
  int terms;
  bool follows;  // whether A is brought to the later time
  std::array<Branch<Real>, most_prony_terms> branches;
};

// The sums of terms for which they are compiled. What a law does not have of one gets the modulus 0. The
// guard may be in each.
inline constexpr Terms viscous_terms[] = {
    {},
    {.volume = true, .pressure = true},
    {.volume = true, .pressure = true, .fibre = true},
    {.solid = MaterialLaw::neo_hookean, .volume = true, .pressure = true},
    {.solid = MaterialLaw::yeoh, .volume = true, .pressure = true},
    {.solid = MaterialLaw::mooney_rivlin, .volume = true, .pressure = true},
    {.solid = MaterialLaw::holzapfel, .volume = true, .pressure = true},
    {.solid = MaterialLaw::corotational}};
// Of domains, whose tetrahedra have the volume term and the guard.
inline constexpr Terms viscous_domain_terms[] = {{},
                                                 {.pressure = true, .fibre = true},
                                                 {.solid = MaterialLaw::neo_hookean, .pressure = true},
                                                 {.solid = MaterialLaw::yeoh, .pressure = true},
                                                 {.solid = MaterialLaw::mooney_rivlin, .pressure = true},
                                                 {.solid = MaterialLaw::holzapfel, .pressure = true},
                                                 {.solid = MaterialLaw::corotational}};
[[gnu::always_inline]] constexpr bool has_all(const Terms& compiled, const Terms& of_law) {
  return compiled.solid == of_law.solid && compiled.volume >= of_law.volume &&
         compiled.pressure >= of_law.pressure && compiled.fibre >= of_law.fibre;
}

// As in WideKernels and SmoothedKernels, of the law and all branches. Stiffness is that of the branches
// alone, at once.
template <class Real>
struct ViscousKernels {
  void (*add_forces)(const PatchArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                     PaddedVector<Real>* f);
  void (*add_stiffness)(const PatchArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                        StiffnessPart part, PaddedVector<Real>* K);
};
template <class Real>
struct ViscousDomainKernels {
  void (*add_forces)(const SmoothedArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                     PaddedVector<Real>* f);
  void (*add_stiffness)(const SmoothedArrays<Real>& patch, const ViscousArrays<Real>& viscous,
                        StiffnessPart part, PaddedVector<Real>* K);
};

template <class Real>
ViscousKernels<Real> viscous_kernels(InstructionSet set);  // of an available set
template <class Real>
ViscousDomainKernels<Real> viscous_domain_kernels(InstructionSet set);

}  // namespace lobe
