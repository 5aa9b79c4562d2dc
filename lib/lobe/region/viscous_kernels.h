// The wide kernels of tetrahedra and smoothing domains whose material has a Prony series (fem/prony.h), and
// the strains of dashpots that they read and write. They are others than those of elastic materials, which
// so pay nothing.
#pragma once

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
