// Warnings for values that are possible but most likely a mistake in units: millimetres, kilopascals, g/cm³.
#include "lobe/scene/unit_checks.h"

#include <algorithm>

#include "lobe/scene/material_constants.h"
#include "lobe/scene/resolve_parts.h"

namespace lobe {
namespace {

void suspect_size(Resolution& resolution, double size) {
  const std::string doubt = doubt_of_size(size);
  if (!doubt.empty()) resolution.warn("mesh", doubt + ": \"mesh_scale\": " + (size > 2 ? "0.001" : "1000"));
}

// Warns of volumetric locking of linear tetrahedra that have no nodal pressure.
void suspect_locking(Resolution& resolution, std::size_t material, const std::string& place) {
  const Setup& setup = resolution.result.setup;
  const Elastic& m = setup.materials[material];
  const double nu = poisson_ratio(m.lambda, m.mu);
  if (nu <= locks_above) return;
  const std::string locks = "Poisson's ratio " + rounded(nu) +
                            ": linear tetrahedra lock (respond too stiffly) above " + rounded(locks_above);
  if (m.nodal_pressure == 0) {
    resolution.warn(place, locks + "; in nonlinear regions \"nodal_pressure\": true helps");
    return;
  }
  std::size_t beyond_reach = 0;
  for (std::size_t t = 0; t < setup.region_of.size(); ++t)
    beyond_reach += setup.material_of[t] == material &&
                    (is_linear(setup.region_of[t]) || setup.region_of[t] == RegionModel::corotational);
  if (beyond_reach == 0) return;
  resolution.warn(place, locks + ", and nodal_pressure does not reach " +
                             counted(beyond_reach, "tetrahedron", "tetrahedra") +
                             " in linear or corotational regions");
}

void suspect_material(Resolution& resolution, const Elastic& m, double size, const std::string& place) {
  if (m.density < 100 || m.density > 10000) {
    resolution.warn(place + "/density",
                    rounded(m.density) + " kg/m³ is unlike tissue" +
                        (m.density < 100 ? "; if it is in g/cm³, multiply it by 1000" : ""));
  }
  const Vec3d& gravity = resolution.scene.gravity;
  const double g = gravity.norm() > 0 ? gravity.norm() : standard_gravity;
  const double sag = expected_sag(m, g, size);
  if (sag <= size && sag >= 1e-6 * size) return;
  resolution.warn(
      place, "under gravity of " + rounded(g) + " m/s² a body of " + rounded(size) +
                 " m sags by ρ g L²/E = " + rounded(sag) +
                 " m: " + (sag > size ? "too soft or too large" : "next to nothing: too stiff or too small") +
                 "; are moduli in Pa and coordinates in m?");
}

}  // namespace

double box_diagonal(const TetMesh& mesh) {
  const Box box = bounding_box(mesh);
  return (box.max - box.min).norm();
}

std::string doubt_of_size(double diagonal) {
  if (diagonal >= 1e-3 && diagonal <= 2) return "";
  return "its bounding box has a diagonal of " + rounded(diagonal) + " m; if it " +
         (diagonal > 2 ? "is in millimetres, scale it by 0.001"
                       : "was scaled from millimetres twice, scale it by 1000");
}

double expected_sag(const Elastic& m, double gravity, double size) {
  double young = young_modulus(m.lambda, m.mu);
  if (m.fibre.any()) {
    const TransverseConstants c = transverse_constants(m);
    young = std::min(c.young_along, c.young_across);
  }
  return m.density * gravity * size * size / young;
}

void warn_of_units(Resolution& resolution) {
  const double size = box_diagonal(resolution.mesh());
  suspect_size(resolution, size);
  const std::vector<Elastic>& materials = resolution.result.setup.materials;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const std::string place = "/materials/" + std::to_string(i);
    suspect_locking(resolution, i, place);
    suspect_material(resolution, materials[i], size, place);
  }
}

}  // namespace lobe
