#include "lobe/scene/grasp_kind.h"

#include <algorithm>
#include <set>

#include "lobe/scene/select_shares.h"

namespace lobe {
namespace {

// They are numbered after the vertices of the mesh, in the order in which cuts make them.
void add_copies(Resolution& resolution, const SceneGrasp& tool, const std::string& place,
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

Grasped select_grasped(const Setup& setup, const SceneGrasp& tool, const std::string& place) {
  if (tool.hold_by == HoldBy::vertices) return {select_vertices(*tool.where, setup.mesh, place), {}};
  Grasped grasped;
  for (const auto& [vertex, share] : select_shares(*tool.where, setup.mesh, tool.hold_by, place)) {
    grasped.vertices.push_back(vertex);
    grasped.shares.push_back(share);
  }
  return grasped;
}

Selector all_of(std::vector<Index> vertices) {
  if (!vertices.empty()) return {SelectVertices{std::move(vertices)}};
  return {SelectNot{{Selector{SelectAll{}}}}};
}

}  // namespace

void KindOf<SceneGrasp>::resolve(Resolution& resolution, SceneGrasp& tool, const std::string& here) {
  const Setup& setup = resolution.result.setup;
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
  tool.vertices = std::move(vertices);
  tool.shares = std::move(shares);
}

void KindOf<SceneGrasp>::summarise(const GraspSetup& setup, nlohmann::ordered_json& entry) {
  entry["vertices"] = setup.vertices.size();
  entry["release"] = setup.release;
}

std::string KindOf<SceneGrasp>::describe(const nlohmann::ordered_json& entry) {
  return std::to_string(entry["vertices"].get<std::size_t>()) + " vertices" +
         (entry["release"].get<bool>() ? ", then released" : "");
}

SceneGrasp KindOf<SceneGrasp>::from_setup(const GraspSetup& setup, Index mesh_vertices) {
  const auto copies = std::lower_bound(setup.vertices.begin(), setup.vertices.end(), mesh_vertices);
  return {setup, all_of({setup.vertices.begin(), copies}), HoldBy::vertices, {copies, setup.vertices.end()}};
}

}  // namespace lobe
