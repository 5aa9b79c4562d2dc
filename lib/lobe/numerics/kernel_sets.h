// Which copy of kernels an instruction set names: one is compiled for each set, in a namespace of its name.
#pragma once

#include <type_traits>

#include "lobe/instruction_set.h"

#define LOBE_DECLARE_KERNELS(set, Kernels, single_precision, double_precision) \
  namespace set {                                                              \
  extern const Kernels<float> single_precision;                                \
  extern const Kernels<double> double_precision;                               \
  }

#ifdef LOBE_X86_KERNELS
#define LOBE_DECLARE_ALL_KERNELS(Kernels, single_precision, double_precision) \
  LOBE_DECLARE_KERNELS(baseline, Kernels, single_precision, double_precision) \
  LOBE_DECLARE_KERNELS(avx2, Kernels, single_precision, double_precision)     \
  LOBE_DECLARE_KERNELS(avx512, Kernels, single_precision, double_precision)
#define LOBE_PICK_KERNELS(name)                           \
  if (set == InstructionSet::avx2) return avx2::name;     \
  if (set == InstructionSet::avx512) return avx512::name; \
  return baseline::name;
#else
#define LOBE_DECLARE_ALL_KERNELS(Kernels, single_precision, double_precision) \
  LOBE_DECLARE_KERNELS(baseline, Kernels, single_precision, double_precision)
#define LOBE_PICK_KERNELS(name) return baseline::name;
#endif

// Defines choose<float>(set) and choose<double>(set), which return the constants of these names of the set.
#define LOBE_CHOOSE_KERNELS(Kernels, choose, single_precision, double_precision) \
  LOBE_DECLARE_ALL_KERNELS(Kernels, single_precision, double_precision)          \
  template <>                                                                    \
  Kernels<float> choose([[maybe_unused]] InstructionSet set) {                   \
    LOBE_PICK_KERNELS(single_precision)                                          \
  }                                                                              \
  template <>                                                                    \
  Kernels<double> choose([[maybe_unused]] InstructionSet set) {                  \
    LOBE_PICK_KERNELS(double_precision)                                          \
  }
