#include <algorithm>
#include <limits>

#include "lobe/scene/read_selector.h"
#include "lobe/scene/tool_kinds.h"

namespace lobe {
namespace {

double mean_edge(const TetMesh& mesh) {  // [m]
  double sum = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> x = tet_points(mesh, t);
    for (const auto& edge : edge_corners) sum += (x.col(edge[0]) - x.col(edge[1])).norm();
  }
  return sum / (6.0 * mesh.tet_count());
}

void read_scalpel(const nlohmann::json& entry, Tool& tool) { tool.snap = entry.value("snap", tool.snap); }

bool read_scalpel_row(const nlohmann::json& row, Tool& tool) {
  if (row.size() != 7) return false;
  tool.heels.push_back(read_vector(row, 4));
  return true;
}

void write_scalpel(const Tool& tool, nlohmann::ordered_json& entry) {
  nlohmann::ordered_json& path = entry["path"];
  for (std::size_t i = 0; i < path.size(); ++i)
    path[i].insert(path[i].end(), {tool.heels[i][0], tool.heels[i][1], tool.heels[i][2]});
  entry["snap"] = tool.snap;
}

void resolve_scalpel(Resolution& resolution, const Tool& tool, const std::string& here) {
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  for (std::size_t i = 0; i < tool.path.size(); ++i) {
    const double length = (tool.heels[i] - tool.path[i].position).norm();
    if (length == 0) resolution.fail(here + "/path/" + std::to_string(i), "tip and heel are the same point");
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
  }
  resolution.result.setup.scalpels.push_back({tool.name, tool.snap, tool.path, tool.heels});
  if (longest > 1.05 * shortest)
    resolution.warn(here + "/path", "the blade's length varies between " + rounded(shortest) + " m and " +
                                        rounded(longest) + " m: it may turn too far from row to row");
  const double edge = mean_edge(resolution.mesh());
  if (longest < edge)
    resolution.warn(here + "/path", "the blade is shorter than the mesh's mean edge, " + rounded(edge) +
                                        " m: it cuts nothing");
}

void summarise_scalpel(const Setup& setup, std::size_t number, nlohmann::ordered_json& entry) {
  entry["snap"] = setup.scalpels[number].snap;
}

void append_scalpels(const ToolSetups& done, Index, std::vector<Tool>& tools) {
  for (const ScalpelSetup& scalpel : done.scalpels) {
    Tool& tool = tools.emplace_back();
    tool.name = scalpel.name;
    tool.type = ScalpelSetup::type;
    tool.snap = scalpel.snap;
    tool.path = scalpel.path;
    tool.heels = scalpel.heels;
  }
}

}  // namespace

extern const ToolKind scalpel_kind;
const ToolKind scalpel_kind{ScalpelSetup::type, "7 numbers: time, tip and heel",
                            read_scalpel,       read_scalpel_row,
                            write_scalpel,      resolve_scalpel,
                            summarise_scalpel,  append_scalpels};

}  // namespace lobe
