// The selectors of a scene, one by one, and what they are made of.
#pragma once

#include <algorithm>
#include <vector>

#include "lobe/scene/scene.h"

namespace lobe {

// Calls visit(selector, whether it is of tetrahedra) for every selector of a scene that is at the top.
template <class SceneType, class Visit>
void for_each_selector(SceneType& scene, const Visit& visit) {
  for (auto& material : scene.materials) {
    if (material.where) visit(*material.where, true);
    if (auto* field = material.fibre ? std::get_if<FibreHarmonic>(&*material.fibre) : nullptr) {
      visit(field->from, false);
      visit(field->to, false);
    }
  }
  for (auto& region : scene.regions)
    if (region.where) visit(*region.where, true);
  for (auto& boundary : scene.boundary) visit(boundary.where, false);
  for (auto& tool : scene.tools)
    if (auto* where = tool.where()) visit(*where, false);
  for (auto& attachment : scene.attachments)
    if (auto* bed = std::get_if<SceneBed>(&attachment.what)) {
      visit(bed->from, false);
      if (bed->to) visit(*bed->to, false);
    }
  if (scene.auto_regions)
    for (auto& gesture : scene.auto_regions->gestures) visit(gesture.where, false);
}

// The selectors that this one is made of; none if it is simple.
inline std::vector<Selector>* parts_of(Selector& selector) {
  if (auto* any = std::get_if<SelectAnyOf>(&selector.value)) return &any->parts;
  if (auto* all = std::get_if<SelectAllOf>(&selector.value)) return &all->parts;
  if (auto* negated = std::get_if<SelectNot>(&selector.value)) return &negated->part;
  return nullptr;
}

// Whether it counts vertices or tetrahedra of one mesh, so that it selects something else on another.
inline bool by_number(Selector selector) {
  if (const auto* parts = parts_of(selector)) return std::any_of(parts->begin(), parts->end(), by_number);
  return std::holds_alternative<SelectVertices>(selector.value) ||
         std::holds_alternative<SelectTetrahedra>(selector.value) ||
         std::holds_alternative<SelectNearest>(selector.value);
}
inline bool selects_by_number(const Scene& scene) {
  bool found = false;
  for_each_selector(scene, [&](const Selector& selector, bool) { found = found || by_number(selector); });
  return found;
}
}  // namespace lobe
