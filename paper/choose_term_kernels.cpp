#include "lobe/numerics/kernel_sets.h"
#include "paper/term_kernels.h"

namespace lobe {

LOBE_CHOOSE_KERNELS(TermKernels, term_kernels, single_term_kernels, double_term_kernels)

}  // namespace lobe
