#include "lobe/fem/law_fault.h"

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"

namespace lobe {

std::string law_fault(const Elastic& elastic) {
  std::string fault;
  with_solid(elastic.law, [&](auto solid) { fault = solid.fault(nonlinear_law(elastic, 0, 0)); });
  return fault;
}

bool spans_plane(const Elastic& elastic, const Vec3d& direction) {
  if (!has_families(elastic.law) || elastic.fibre_angle == 0) return true;
  const Vec3d plane = Vec3d(elastic.fibre_plane.data()).stableNormalized();
  return plane.cross(direction).norm() > 1e-3;
}

}  // namespace lobe
