// Which copy of kernels an instruction set names: one is compiled for each set, in a namespace of its name.
#pragma once

#include <stdexcept>
#include <type_traits>

#include "lobe/instruction_set.h"

#define LOBE_DECLARE_KERNELS(set, Kernels, single_precision, double_precision) \
  namespace set {                                                              \
  extern const Kernels<float> single_precision;                                \
  extern const Kernels<double> double_precision;                               \
  }

#define LOBE_DECLARE_ALL_KERNELS(Kernels, single_precision, double_precision) \
  LOBE_DECLARE_KERNELS(baseline, Kernels, single_precision, double_precision) \
  LOBE_DECLARE_KERNELS(avx2, Kernels, single_precision, double_precision)     \
  LOBE_DECLARE_KERNELS(avx512, Kernels, single_precision, double_precision)

// CMake defines LOBE_HAS_… for every set that is compiled.
#ifdef LOBE_HAS_BASELINE
#define LOBE_PICK_BASELINE(name) \
  if (set == InstructionSet::baseline) return baseline::name;
#else
#define LOBE_PICK_BASELINE(name)
#endif
#ifdef LOBE_HAS_AVX2
#define LOBE_PICK_AVX2(name) \
  if (set == InstructionSet::avx2) return avx2::name;
#else
#define LOBE_PICK_AVX2(name)
#endif
#ifdef LOBE_HAS_AVX512
#define LOBE_PICK_AVX512(name) \
  if (set == InstructionSet::avx512) return avx512::name;
#else
#define LOBE_PICK_AVX512(name)
#endif
#define LOBE_PICK_KERNELS(name) \
  LOBE_PICK_BASELINE(name)      \
  LOBE_PICK_AVX2(name)          \
  LOBE_PICK_AVX512(name)        \
  throw std::logic_error("kernels of an instruction set that was not compiled");

// Defines choose<float>(set) and choose<double>(set), which return the constants of these names of the set.
#define LOBE_CHOOSE_KERNELS(Kernels, choose, single_precision, double_precision) \
  LOBE_DECLARE_ALL_KERNELS(Kernels, single_precision, double_precision)          \
  template <>                                                                    \
  Kernels<float> choose(InstructionSet set) {                                    \
    LOBE_PICK_KERNELS(single_precision)                                          \
  }                                                                              \
  template <>                                                                    \
  Kernels<double> choose(InstructionSet set) {                                   \
    LOBE_PICK_KERNELS(double_precision)                                          \
  }
