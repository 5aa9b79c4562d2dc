#include "lobe/scene/tool_kinds.h"

#include <algorithm>
#include <array>

namespace lobe {

extern const ToolKind grasp_kind, cautery_kind, scalpel_kind, probe_kind;

namespace {

constexpr std::array kinds{&grasp_kind, &cautery_kind, &scalpel_kind, &probe_kind};

}  // namespace

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
