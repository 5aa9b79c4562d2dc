// The body of a refined mesh: each child has the material, region and share of its parent.
#pragma once

#include "lobe/fem/body.h"
#include "lobe/mesh/refine.h"

namespace lobe {

Body refined_body(const Body& body, const RefinedMesh& refined);

}  // namespace lobe
