#include "commands.h"
#include "lobe_cholmod/cholmod_factor.h"

namespace lobe::program {

const Solver linked_solver{"cholmod", make_cholmod, make_cholmod};

}  // namespace lobe::program
