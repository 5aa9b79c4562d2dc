#include "lobe/scene/tool_kinds.h"

#include <algorithm>
#include <array>

namespace lobe {

extern const ToolKind grasp_kind, cautery_kind, scalpel_kind, probe_kind, clip_applier_kind;

namespace {

constexpr std::array kinds{&grasp_kind, &cautery_kind, &scalpel_kind, &probe_kind, &clip_applier_kind};

}  // namespace

bool read_turning_row(const nlohmann::json& row, Tool& tool) {
  if (row.size() == 8)
    for (int i = 0; i < 4; ++i) tool.path.back().orientation[i] = row[std::size_t(4 + i)].get<double>();
  return row.size() == 4 || row.size() == 8;
}

void write_turning_row(const Tool& tool, std::size_t number, nlohmann::ordered_json& row) {
  if (const Eigen::Vector4d& q = tool.path[number].orientation; q != PathPoint().orientation)
    row.insert(row.end(), {q[0], q[1], q[2], q[3]});
}

const ToolKind& kind_of(const Tool& tool) {
  const auto at =
      std::find_if(kinds.begin(), kinds.end(), [&](const ToolKind* kind) { return kind->type == tool.type; });
  if (at == kinds.end()) throw InputError(tool.pointer + "/type", "is no kind of tool: " + tool.type);
  return **at;
}

void append_tools(const ToolSetups& done, Index mesh_vertices, std::vector<Tool>& tools) {
  for (const ToolKind* kind : kinds) kind->append(done, mesh_vertices, tools);
}

}  // namespace lobe
