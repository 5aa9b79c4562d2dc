// Crumbs are tiny parts that a blade would cut off. They stay attached, and nothing is deleted.
#pragma once

#include "lobe/scalpel/grains.h"

namespace lobe {

// Removes from the faces to be opened (codes 4 × grain + face) those by which crumbs stay attached: the
// largest face around each crumb. A crumb is a part of at most 64 grains that fills less than a thousandth of
// the mean tetrahedron. Returns the number of crumbs.
Index keep_crumbs(const Grains& grains, std::vector<Index>& faces);

}  // namespace lobe
