#include "lobe/numerics/kernel_sets.h"
#include "lobe/region/viscous_kernels.h"

namespace lobe {

LOBE_CHOOSE_KERNELS(WideKernels, wide_kernels, single_kernels, double_kernels)
LOBE_CHOOSE_KERNELS(SmoothedKernels, smoothed_kernels, smoothed_single_kernels, smoothed_double_kernels)
LOBE_CHOOSE_KERNELS(ViscousKernels, viscous_kernels, viscous_single_kernels, viscous_double_kernels)
LOBE_CHOOSE_KERNELS(ViscousDomainKernels, viscous_domain_kernels, viscous_domain_single_kernels,
                    viscous_domain_double_kernels)

}  // namespace lobe
