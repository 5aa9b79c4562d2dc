#include "lobe/contact/gap_kernels.h"
#include "lobe/numerics/kernel_sets.h"

namespace lobe {

namespace baseline {
extern const GapKernels self_gap_kernels;
}
namespace avx2 {
extern const GapKernels self_gap_kernels;
}
namespace avx512 {
extern const GapKernels self_gap_kernels;
}

GapKernels gap_kernels(InstructionSet set) { LOBE_PICK_KERNELS(self_gap_kernels) }

}  // namespace lobe
