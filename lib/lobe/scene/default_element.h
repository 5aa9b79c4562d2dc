// Which element a material's tetrahedra are where the scene does not say.
//
// - Edge-smoothed ones have the same vertices, and are far nearer to the truth of their body
//   (benchmarks/results/elements.md).
// - Plain ones are left in a scene that has something smoothed ones do not go with (setup/exclusions.h), or
//   reduced regions, whose lattice hides the gain.
// - Smoothed ones lock, too, above Poisson's ratio 0.45: there they have nodal_pressure 1, unless the scene
//   says otherwise, has something it does not go with, or precomputed regions, which may have to expand.
#pragma once

#include "lobe/scene/scene.h"

namespace lobe {

// Returns the material with its element, and its nodal pressure, named.
Material with_default_element(const Scene& scene, Material material);

}  // namespace lobe
