#include "commands.h"

namespace lobe::program {

const Solver linked_solver{"eigen", make_ldlt};

}  // namespace lobe::program
