#include "lobe/scene/default_element.h"

#include "lobe/scene/material_constants.h"
#include "lobe/scene/resolve_parts.h"

namespace lobe {
namespace {

bool may_be_reduced(const Scene& scene, const Options& used) {
  return used.has(option_of(RegionModel::reduced)) || (scene.auto_regions && scene.auto_regions->reduced);
}

bool may_be_precomputed(const Scene& scene, const Options& used) {
  return used.has(option_of(RegionModel::precomputed)) ||
         (scene.auto_regions && scene.auto_regions->precomputed);
}

bool locks(const Material& material) {
  constexpr double rounding = 1e-9;  // of ν from λ and μ
  const Elastic elastic = elastic_of(material);
  return poisson_ratio(elastic.lambda, elastic.mu) > locks_above + rounding;
}

}  // namespace

Material with_default_element(const Scene& scene, Material material) {
  const Options used = options_of(scene);
  if (!material.element) {
    const bool is_smoothed = goes_with(Option::edge_smoothed, used) && !may_be_reduced(scene, used);
    material.element = is_smoothed ? ElementType::edge_smoothed : ElementType::tetrahedron;
  }
  if (!material.nodal_pressure) {
    const bool is_averaged = material.element == ElementType::edge_smoothed && locks(material) &&
                             !elastic_of(material).relaxes_in_volume() &&
                             goes_with(Option::nodal_pressure, used) && !may_be_reduced(scene, used) &&
                             !may_be_precomputed(scene, used);
    material.nodal_pressure = is_averaged ? 1 : 0;
  }
  return material;
}

}  // namespace lobe
