// The loop over the stored terms of a patch, compiled once per instruction set as those of the library are
// (lobe/region/wide_kernels.h).
#pragma once

#include "lobe/instruction_set.h"
#include "paper/term_block.h"

namespace lobe {

template <class Real>
struct TermKernels {
  // Adds the forces of the patch's terms to those of its vertices [N], carrier by carrier.
  void (*add_term_forces)(const TermArrays<Real>& patch, PaddedVector<Real>* f);
};

template <class Real>
TermKernels<Real> term_kernels(InstructionSet set);  // of an available set

}  // namespace lobe
