// What a scene says of each kind of tool, in addition to its name, type and path. Each kind has a file
// (grasp_kind.cpp, …) and a row in tool_kinds.cpp. Internal, not part of the public interface.
#pragma once

#include <nlohmann/json.hpp>

#include "lobe/scene/resolve_parts.h"
#include "lobe/scene/selector_keys.h"
#include "lobe/scene/tool_keys.h"
#include "lobe/tool/tool_lists.h"

namespace lobe {

struct ToolKind {
  const char* type;
  const char* row;  // what a row of its path has
  // Reads and writes what the tool has in addition to name, type and path.
  void (*read)(const nlohmann::json& entry, Tool& tool);
  void (*write)(const Tool& tool, nlohmann::ordered_json& entry);
  // Reads the rest of a row. The last point of the path has its time and position already. False if it is no
  // such row.
  bool (*read_row)(const nlohmann::json& row, Tool& tool);
  // Appends the rest of the row of this number, after time and place.
  void (*write_row)(const Tool& tool, std::size_t number, nlohmann::ordered_json& row);
  // Adds the tool to the setup, and its faults and warnings.
  void (*resolve)(Resolution& resolution, const Tool& tool, const std::string& place);
  // Makes the command by which a hand brings the tool to the first point of its path. None: hands take hold.
  BringTool (*bring)(Resolution& resolution, const Tool& tool, const std::string& place);
  // Adds what `lobe check` says of the tool of this number of its kind.
  void (*summarise)(const Setup& setup, std::size_t number, nlohmann::ordered_json& entry);
  // Appends what hands have done, as tools of a scene whose mesh has so many vertices.
  void (*append)(const ToolSetups& done, Index mesh_vertices, std::vector<Tool>& tools);
};

// Rows of 4 numbers, time and place, or of 8 with a quaternion.
bool read_turning_row(const nlohmann::json& row, Tool& tool);
void write_turning_row(const Tool& tool, std::size_t number, nlohmann::ordered_json& row);

// By a table of keys.
template <const auto& table>
void read_keys_of(const nlohmann::json& entry, Tool& tool) {
  keys::read_rows(table, entry, tool, "");
}
template <const auto& table>
void write_keys_of(const Tool& tool, nlohmann::ordered_json& entry) {
  keys::write_rows(table, tool, entry);
}

const ToolKind& kind_of(const Tool& tool);
void append_tools(const ToolSetups& done, Index mesh_vertices,
                  std::vector<Tool>& tools);  // tools of all kinds

}  // namespace lobe
