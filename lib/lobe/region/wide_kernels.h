// The loops that every instruction set has a copy of its own of: wide_kernels.cpp is compiled once per set. They
// take plain arrays and share no inline function with the rest of the library, of which the linker might else
// keep the copy that an older processor cannot run.
#pragma once

#include "lobe/instruction_set.h"
#include "lobe/region/element_block.h"

namespace lobe {

enum class ElementPart { svk, volume_term, both };

template <class Real>
struct ElementArrays {
  const ElementBlock<Real>* blocks;
  const PressureBlock<Real>* pressure_blocks;  // null without nodal pressure
  const Real* pressure;                        // per node [Pa]
  const Real* u;                               // 3 × #vertices [m]
};

template <class Real>
struct WideKernels {
  // Forces on the corners of blocks [begin, end) [N]: 12 rows per block of the whole array, corner by corner.
  void (*forces)(const ElementArrays<Real>& arrays, ElementPart part, Index begin, Index end, Real* rows);
  void (*volume_strains)(const ElementArrays<Real>& arrays, Index block, Real* row);  // V tr E [m³]
};

template <class Real>
WideKernels<Real> wide_kernels(InstructionSet set);  // of an available set

}  // namespace lobe
