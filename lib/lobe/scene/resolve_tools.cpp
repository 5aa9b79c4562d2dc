#include <algorithm>
#include <limits>
#include <set>

#include "lobe/scene/resolve_parts.h"

namespace lobe {
namespace {

// Does the segment from a to b meet the box? Slabs: the parameters s at which a + s(b − a) is inside each.
bool meets_box(const Vec3d& a, const Vec3d& b, const Vec3d& low, const Vec3d& high) {
  double enter = 0, leave = 1;
  for (int i = 0; i < 3; ++i) {
    const double step = b[i] - a[i];
    if (step == 0) {
      if (a[i] < low[i] || a[i] > high[i]) return false;
      continue;
    }
    const double s = (low[i] - a[i]) / step, t = (high[i] - a[i]) / step;
    enter = std::max(enter, std::min(s, t));
    leave = std::min(leave, std::max(s, t));
  }
  return enter <= leave;
}

double mean_edge(const TetMesh& mesh) {  // [m]
  double sum = 0;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> x = tet_points(mesh, t);
    for (const auto& edge : edge_corners) sum += (x.col(edge[0]) - x.col(edge[1])).norm();
  }
  return sum / (6.0 * mesh.tet_count());
}

bool passes_near(const Tool& tool, const TetMesh& mesh) {
  const Box box = bounding_box(mesh);
  const Vec3d low = box.min.array() - tool.radius, high = box.max.array() + tool.radius;
  for (std::size_t i = 0; i < tool.path.size(); ++i) {
    const std::size_t next = std::min(i + 1, tool.path.size() - 1);
    if (meets_box(tool.path[i].position, tool.path[next].position, low, high)) return true;
  }
  return false;
}

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

void resolve_grasp(Resolution& resolution, const Tool& tool, const std::string& here) {
  Setup& setup = resolution.result.setup;
  const std::size_t before = resolution.faults.size();
  auto vertices =
      resolution.selected([&] { return select_vertices(*tool.where, setup.mesh, here + "/where"); });
  if (vertices.empty() && !tool.copies.empty() && resolution.scene.auto_regions)
    resolution.fail(here + "/where", "must select a vertex of the mesh, beside automatic regions");
  if (vertices.empty() && tool.copies.empty() && resolution.faults.size() == before) {
    resolution.fail_empty(here + "/where", "vertex");
  }
  std::set<Index> held;
  for (const PrescribedVertex& p : setup.prescribed) held.insert(p.vertex);
  const auto fixed =
      std::count_if(vertices.begin(), vertices.end(), [&](Index v) { return held.contains(v); });
  if (fixed > 0) {
    resolution.warn(here, std::to_string(fixed) + " of the " +
                              counted(vertices.size(), "vertex", "vertices") +
                              " it grasps are held by \"boundary\"");
  }
  add_copies(resolution, tool, here + "/copies", vertices);
  setup.grasps.push_back({tool.name, vertices, tool.path, tool.release});
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

}  // namespace

void resolve_tools(Resolution& resolution) {
  const Scene& scene = resolution.scene;
  for (std::size_t i = 0; i < scene.tools.size(); ++i) {
    const Tool& tool = scene.tools[i];
    const std::string here = "/tools/" + std::to_string(i);
    if (tool.type == ToolType::grasp) {
      resolve_grasp(resolution, tool, here);
    } else if (tool.type == ToolType::scalpel) {
      resolve_scalpel(resolution, tool, here);
    } else {
      resolution.result.setup.cauteries.push_back({tool.name, tool.radius, tool.path});
      if (!passes_near(tool, resolution.mesh())) {
        resolution.warn(here + "/path", "never comes within its radius of the mesh's bounding box");
      }
    }
    const double end = tool.path.back().time;
    if (end > scene.time.duration) {
      resolution.warn(here + "/path", "ends at " + rounded(end) + " s, after the run's duration of " +
                                          rounded(scene.time.duration) + " s");
    }
  }
}

}  // namespace lobe
