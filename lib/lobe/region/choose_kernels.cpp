#include "lobe/numerics/kernel_sets.h"
#include "lobe/region/wide_kernels.h"

namespace lobe {

LOBE_CHOOSE_KERNELS(WideKernels, wide_kernels, single_kernels, double_kernels)

}  // namespace lobe
