// What a scene says of each kind of tool, beside its name, type and path. Each kind has a file
// (grasp_kind.cpp, …) and a row in tool_kinds.cpp. Internal: not part of the public interface.
#pragma once

#include <nlohmann/json.hpp>

#include "lobe/scene/resolve_parts.h"

namespace lobe {

struct ToolKind {
  const char* type;
  const char* row;  // what a row of its path has
  // What it has beside name, type, where and path.
  void (*read)(const nlohmann::json& entry, Tool& tool);
  // The rest of a row whose time and position the last point of the path has; false if it is no such row.
  bool (*read_row)(const nlohmann::json& row, Tool& tool);
  void (*write)(const Tool& tool, nlohmann::ordered_json& entry);
  // Into the setup; with faults and warnings.
  void (*resolve)(Resolution& resolution, const Tool& tool, const std::string& place);
  // What `lobe check` says of the one of this number of its kind.
  void (*summarise)(const Setup& setup, std::size_t number, nlohmann::ordered_json& entry);
  // What hands have done, as tools of a scene whose mesh has so many vertices.
  void (*append)(const ToolSetups& done, Index mesh_vertices, std::vector<Tool>& tools);
};

const ToolKind& kind_of(const Tool& tool);
void append_tools(const ToolSetups& done, Index mesh_vertices, std::vector<Tool>& tools);  // of all kinds

}  // namespace lobe
