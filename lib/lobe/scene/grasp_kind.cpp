#include <algorithm>
#include <set>

#include "lobe/scene/select_shares.h"
#include "lobe/scene/tool_kinds.h"

namespace lobe {
namespace {

// They are numbered after the vertices of the mesh, in the order in which cuts make them.
void add_copies(Resolution& resolution, const Tool& tool, const std::string& place,
                std::vector<Index>& vertices) {
  std::vector<Index> copies = tool.copies;
  std::sort(copies.begin(), copies.end());
  const Index count = resolution.mesh().vertex_count();
  if (!copies.empty() && copies.front() < count)
    resolution.fail(place, std::to_string(copies.front()) + " is a vertex of the mesh, which has " +
                               std::to_string(count) +
                               "; copies have higher numbers, others belong to \"where\"");
  vertices.insert(vertices.end(), copies.begin(), copies.end());
}

struct Grasped {
  std::vector<Index> vertices;
  std::vector<double> shares;  // none: all wholly
};

Grasped select_grasped(const Setup& setup, const Tool& tool, const std::string& place) {
  if (tool.hold_by == HoldBy::vertices) return {select_vertices(*tool.where, setup.mesh, place), {}};
  Grasped grasped;
  for (const auto& [vertex, share] : select_shares(*tool.where, setup.mesh, tool.hold_by, place)) {
    grasped.vertices.push_back(vertex);
    grasped.shares.push_back(share);
  }
  return grasped;
}

void resolve_grasp(Resolution& resolution, const Tool& tool, const std::string& here) {
  Setup& setup = resolution.result.setup;
  const std::size_t before = resolution.faults.size();
  auto [vertices, shares] = resolution.selected([&] { return select_grasped(setup, tool, here + "/where"); });
  if (vertices.empty() && !tool.copies.empty() && resolution.scene.auto_regions)
    resolution.fail(here + "/where", "must select a vertex of the mesh if regions are automatic");
  if (vertices.empty() && tool.copies.empty() && resolution.faults.size() == before) {
    resolution.fail_empty(here + "/where", "vertex");
  }
  std::set<Index> fixed;
  for (const PrescribedVertex& p : setup.prescribed)
    if (p.axes == all_axes) fixed.insert(p.vertex);
  const auto unmoved =
      std::count_if(vertices.begin(), vertices.end(), [&](Index v) { return fixed.contains(v); });
  if (unmoved > 0) {
    resolution.warn(here, std::to_string(unmoved) + " of the " +
                              counted(vertices.size(), "vertex", "vertices") +
                              " it grasps are held by \"boundary\" in all components, and stay there");
  }
  add_copies(resolution, tool, here + "/copies", vertices);
  if (!shares.empty()) shares.resize(vertices.size(), 1);  // copies are grasped wholly
  setup.grasps.push_back({tool.name, vertices, tool.path, tool.release, shares});
}

void summarise_grasp(const Setup& setup, std::size_t number, nlohmann::ordered_json& entry) {
  entry["vertices"] = setup.grasps[number].vertices.size();
  entry["release"] = setup.grasps[number].release;
}

Selector all_of(std::vector<Index> vertices) {
  if (!vertices.empty()) return {SelectVertices{std::move(vertices)}};
  return {SelectNot{{Selector{SelectAll{}}}}};
}

void append_grasps(const ToolSetups& done, Index mesh_vertices, std::vector<Tool>& tools) {
  for (const GraspSetup& grasp : done.grasps) {
    Tool& tool = tools.emplace_back();
    tool.name = grasp.name;
    tool.type = GraspSetup::type;
    tool.path = grasp.path;
    tool.release = grasp.release;
    const auto copies = std::lower_bound(grasp.vertices.begin(), grasp.vertices.end(), mesh_vertices);
    tool.where = all_of({grasp.vertices.begin(), copies});
    tool.copies = {copies, grasp.vertices.end()};
  }
}

}  // namespace

extern const ToolKind grasp_kind;
const ToolKind grasp_kind{GraspSetup::type,
                          "4 numbers, or 8 with a quaternion",
                          read_keys_of<keys::grasp_keys>,
                          write_keys_of<keys::grasp_keys>,
                          read_turning_row,
                          write_turning_row,
                          resolve_grasp,
                          nullptr,
                          summarise_grasp,
                          append_grasps};

}  // namespace lobe
