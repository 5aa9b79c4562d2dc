// Finds floating pieces: pieces of a body that can move as a rigid body. Their static equations are singular.
#pragma once

#include <functional>

#include "lobe/fem/elements.h"
#include "lobe/solve/unknowns.h"

namespace lobe {

// Whether the given components of a piece's vertices hold it against all six rigid motions.
bool is_held(const Elements& elements, const std::vector<Index>& piece,
             const std::function<bool(Index vertex, int axis)>& is_prescribed);

// Throws InputError that names the first piece (tetrahedra that are connected by faces) whose given
// components do not hold it against all six rigid motions. Vertices that it shares with a piece which is held
// count as given, and so do components with a spring: 3 × #vertices [N/m], or no column.
void refuse_floating_pieces(const Elements& elements, const Unknowns& unknowns,
                            const Mat3X<double>& springs = Mat3X<double>(3, 0));

}  // namespace lobe
