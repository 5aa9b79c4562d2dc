#include "lobe/lattice/cell_kernels.h"
#include "lobe/numerics/kernel_sets.h"

namespace lobe {

LOBE_CHOOSE_KERNELS(CellKernels, cell_kernels, single_cell_kernels, double_cell_kernels)

}  // namespace lobe
