// Whether the moduli of a material make a solid of its law.
#pragma once

#include <string>

#include "lobe/fem/body.h"

namespace lobe {

std::string law_fault(const Elastic& elastic);  // says why not; empty: they make one
// Says what is wrong with the Prony series, alone or beside the other moduli; empty: nothing.
std::string viscosity_fault(const Elastic& elastic);

// Whether a law with two families of fibres knows their plane where this unit vector is their direction. True
// for other laws.
bool spans_plane(const Elastic& elastic, const Vec3d& direction);

}  // namespace lobe
