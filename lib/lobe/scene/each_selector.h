// The selectors of a scene, one by one, and what they are made of.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "lobe/scene/scene.h"

namespace lobe {

inline Selects selected_by(const Boundary& entry) {
  if (entry.kind == Boundary::Kind::traction || entry.kind == Boundary::Kind::pressure) return Selects::faces;
  return entry.hold_by == HoldBy::vertices ? Selects::vertices : Selects::shares;
}
inline Selects selected_by(const Tool& tool) {
  const bool is_partly = tool.is<GraspSetup>() && tool.as<GraspSetup>().hold_by != HoldBy::vertices;
  return is_partly ? Selects::shares : Selects::vertices;
}

// Calls visit(selector, what, entry, key) for every selector at the top of a scene; entry + key is its JSON
// pointer.
template <class SceneType, class Visit>
void for_each_selector(SceneType& scene, const Visit& visit) {
  const auto each = [&](auto& entries, const std::string& list, const auto& visit_entry) {
    for (std::size_t i = 0; i < entries.size(); ++i) visit_entry(entries[i], list + std::to_string(i));
  };
  each(scene.materials, "/materials/", [&](auto& material, const std::string& entry) {
    if (material.where) visit(*material.where, Selects::tets, entry, "/where");
    if (auto* field = material.fibre ? std::get_if<FibreHarmonic>(&*material.fibre) : nullptr) {
      visit(field->from, Selects::vertices, entry, "/fibre/harmonic/from");
      visit(field->to, Selects::vertices, entry, "/fibre/harmonic/to");
    }
  });
  each(scene.regions, "/regions/", [&](auto& region, const std::string& entry) {
    if (region.where) visit(*region.where, Selects::tets, entry, "/where");
  });
  each(scene.boundary, "/boundary/", [&](auto& boundary, const std::string& entry) {
    visit(boundary.where, selected_by(boundary), entry, "/where");
  });
  each(scene.tools, "/tools/", [&](auto& tool, const std::string& entry) {
    if (auto* where = tool.where()) visit(*where, selected_by(tool), entry, "/where");
  });
  for_each_kind(scene, [&](auto& all) {
    using Force = typename std::remove_cvref_t<decltype(all)>::value_type;
    each(all, "/" + std::string(Force::key) + "/", [&](auto& force, const std::string& entry) {
      Force::for_each_selector(
          force, [&](auto& selector, Selects what, const char* key) { visit(selector, what, entry, key); });
    });
  });
  if (scene.auto_regions)
    each(scene.auto_regions->gestures, "/regions/auto/gestures/",
         [&](auto& gesture, const std::string& entry) {
           visit(gesture.where, Selects::vertices, entry, "/where");
         });
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
  for_each_selector(scene,
                    [&](const Selector& selector, auto&&...) { found = found || by_number(selector); });
  return found;
}
}  // namespace lobe
