#include "lobe/contact/touch_kernels.h"
#include "lobe/numerics/kernel_sets.h"

namespace lobe {

namespace baseline {
extern const TouchKernels double_touch_kernels;
}
namespace avx2 {
extern const TouchKernels double_touch_kernels;
}
namespace avx512 {
extern const TouchKernels double_touch_kernels;
}

TouchKernels touch_kernels(InstructionSet set) { LOBE_PICK_KERNELS(double_touch_kernels) }

}  // namespace lobe
