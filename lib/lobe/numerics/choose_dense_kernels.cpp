#include "lobe/numerics/dense_kernels.h"
#include "lobe/numerics/kernel_sets.h"

namespace lobe {

LOBE_CHOOSE_KERNELS(DenseKernels, dense_kernels, single_dense_kernels, double_dense_kernels)

}  // namespace lobe
