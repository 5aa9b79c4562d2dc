// The mean material of several tetrahedra.
#pragma once

#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

struct MeanMaterial {
  double volume = 0;                // volume of the tetrahedra [m³]
  Elastic material;                 // moduli are means over the volume; the law is that of most of it
  Vec3d direction = Vec3d::Zero();  // direction that most of the fibres have; zero without fibres
};

// Averages those of the tetrahedra that are alive. If none is, the volume is 0 and the material arbitrary.
MeanMaterial mean_material(const Elements& elements, const std::vector<Index>& tets);

}  // namespace lobe
