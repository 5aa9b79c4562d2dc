#include "lobe/fem/law_fault.h"

#include <span>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"

namespace lobe {

std::string law_fault(const Elastic& elastic) {
  std::string fault;
  with_solid(elastic.law, [&](auto solid) { fault = solid.fault(nonlinear_law(elastic, 0, 0)); });
  return fault;
}

std::string viscosity_fault(const Elastic& elastic) {
  const std::span<const PronyTerm> series = elastic.prony_series();
  const std::string fault = prony_fault(series);
  if (!fault.empty()) return fault;
  for (std::size_t i = series.size(); i < elastic.viscosity.size(); ++i)
    if (elastic.viscosity[i] != PronyTerm{}) return "terms of a Prony series must follow each other";
  if (elastic.relaxes_in_volume() && elastic.nodal_pressure > 0)
    return "a share of bulk of a Prony series does not go with nodal_pressure, which is not viscous";
  return "";
}

bool spans_plane(const Elastic& elastic, const Vec3d& direction) {
  if (!has_families(elastic.law) || elastic.fibre_angle == 0) return true;
  const Vec3d plane = Vec3d(elastic.fibre_plane.data()).stableNormalized();
  return plane.cross(direction).norm() > 1e-3;
}

}  // namespace lobe
