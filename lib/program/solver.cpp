#include "commands.h"
#include "lobe/numerics/supernodal_factor.h"

namespace lobe::program {

const Solver linked_solver{"eigen", make_ldlt, make_supernodal};

}  // namespace lobe::program
