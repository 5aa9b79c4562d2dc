// Regions as lists of tetrahedra: what a scene states in place of selectors, or of regions that lobe chooses.
#pragma once

#include "lobe/scene/scene.h"

namespace lobe {

// Replaces the regions of a scene. Frame, cells and tolerance are those of its former regions.
void list_regions(const std::vector<RegionModel>& region_of,  // per tetrahedron
                  Scene& scene);

// Replaces regions that lobe chooses or measures by those that it has chosen for this setup. Another
// measurement might choose other ones.
void state_regions(const Setup& setup, Scene& scene);

}  // namespace lobe
