// Which copy of the dense kernels an instruction set names.
#include <type_traits>

#include "lobe/numerics/dense_kernels.h"

namespace lobe {

#define LOBE_DECLARE_KERNELS(set)                         \
  namespace set {                                         \
  extern const DenseKernels<float> single_dense_kernels;  \
  extern const DenseKernels<double> double_dense_kernels; \
  }
LOBE_DECLARE_KERNELS(baseline)
#ifdef LOBE_X86_KERNELS
LOBE_DECLARE_KERNELS(avx2)
LOBE_DECLARE_KERNELS(avx512)
#endif

template <>
DenseKernels<float> dense_kernels(InstructionSet set) {
#ifdef LOBE_X86_KERNELS
  if (set == InstructionSet::avx2) return avx2::single_dense_kernels;
  if (set == InstructionSet::avx512) return avx512::single_dense_kernels;
#endif
  (void)set;
  return baseline::single_dense_kernels;
}

template <>
DenseKernels<double> dense_kernels(InstructionSet set) {
#ifdef LOBE_X86_KERNELS
  if (set == InstructionSet::avx2) return avx2::double_dense_kernels;
  if (set == InstructionSet::avx512) return avx512::double_dense_kernels;
#endif
  (void)set;
  return baseline::double_dense_kernels;
}

}  // namespace lobe
