// Which copy of the wide kernels an instruction set names.
#include <type_traits>

#include "lobe/region/wide_kernels.h"

namespace lobe {

#define LOBE_DECLARE_KERNELS(set)                  \
  namespace set {                                  \
  extern const WideKernels<float> single_kernels;  \
  extern const WideKernels<double> double_kernels; \
  }
LOBE_DECLARE_KERNELS(baseline)
#ifdef LOBE_X86_KERNELS
LOBE_DECLARE_KERNELS(avx2)
LOBE_DECLARE_KERNELS(avx512)
#endif

template <>
WideKernels<float> wide_kernels(InstructionSet set) {
#ifdef LOBE_X86_KERNELS
  if (set == InstructionSet::avx2) return avx2::single_kernels;
  if (set == InstructionSet::avx512) return avx512::single_kernels;
#endif
  (void)set;
  return baseline::single_kernels;
}

template <>
WideKernels<double> wide_kernels(InstructionSet set) {
#ifdef LOBE_X86_KERNELS
  if (set == InstructionSet::avx2) return avx2::double_kernels;
  if (set == InstructionSet::avx512) return avx512::double_kernels;
#endif
  (void)set;
  return baseline::double_kernels;
}

}  // namespace lobe
