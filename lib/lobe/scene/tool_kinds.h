// All kinds of tools in scenes. Internal, not part of the public interface.
#pragma once

#include "lobe/scene/cautery_kind.h"
#include "lobe/scene/clip_applier_kind.h"
#include "lobe/scene/grasp_kind.h"
#include "lobe/scene/needle_kind.h"
#include "lobe/scene/probe_kind.h"
#include "lobe/scene/scalpel_kind.h"
#include "lobe/scene/scene_keys.h"

namespace lobe {

// Calls visit(tool) for an empty tool of each kind.
template <class Visit>
void for_each_kind_in_scenes(const Visit& visit) {
  [&]<class... Said>(const std::variant<Said...>*) {
    (visit(Said()), ...);
  }(static_cast<const decltype(Tool::kind)*>(nullptr));
}

// Adds what `lobe check` says of a tool to an entry that has its type; `number`: among those of its kind.
void summarise(const ToolSetups& setups, const Tool& tool, std::size_t number, nlohmann::ordered_json& entry);
std::string describe_tool(const nlohmann::ordered_json& entry);  // the same in words
// Appends what hands have done, as tools of a scene whose mesh has so many vertices.
void append_tools(const ToolSetups& done, Index mesh_vertices, std::vector<Tool>& tools);

}  // namespace lobe
