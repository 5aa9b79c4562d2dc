// Crumbs: what a blade would cut off that is hardly there. They stay where they hang, and nothing is deleted.
#pragma once

#include "lobe/scalpel/grains.h"

namespace lobe {

// Of faces that are to be opened, as codes 4 × grain + face, takes away those by which crumbs are to hang on: the
// largest around each. A crumb is a part of at most 64 grains that fill less than a thousandth of the mesh's mean
// tetrahedron. Returns how many there are.
Index keep_crumbs(const Grains& grains, std::vector<Index>& faces);

}  // namespace lobe
