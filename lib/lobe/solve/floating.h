// Pieces of a body that nothing keeps from moving as a rigid body: their static equations are singular.
#pragma once

#include "lobe/region/elements.h"
#include "lobe/solve/unknowns.h"

namespace lobe {

// Throws InputError that names the first piece (tetrahedra that hang together by faces) whose given components leave
// it one of the six rigid motions. Vertices that it shares with a piece which is held count as given.
void refuse_floating_pieces(const Elements& elements, const Unknowns& unknowns);

}  // namespace lobe
