#include "lobe/scene/scalpel_kind.h"

#include <algorithm>
#include <limits>

#include "lobe/diagnostics/locate.h"
#include "lobe/scalpel/far_move.h"

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

// Lengths of the blade, and how far an end of it goes in a second, at most [m].
struct Extent {
  double shortest = std::numeric_limits<double>::infinity(), longest = 0, speed = 0;
};

Extent extent_of(const SceneScalpel& tool) {
  Extent extent;
  for (std::size_t i = 0; i < tool.heels.size(); ++i) {
    const double length = (tool.heels[i] - tool.path[i].position).norm();
    extent.shortest = std::min(extent.shortest, length);
    extent.longest = std::max(extent.longest, length);
    if (i == 0) continue;
    const double way = std::max((tool.path[i].position - tool.path[i - 1].position).norm(),
                                (tool.heels[i] - tool.heels[i - 1]).norm());
    extent.speed = std::max(extent.speed, way / (tool.path[i].time - tool.path[i - 1].time));
  }
  return extent;
}

// Whether the box of what it sweeps meets that of the mesh.
bool comes_near(const SceneScalpel& tool, const TetMesh& mesh) {
  const Box box = bounding_box(mesh);
  Vec3d low = tool.heels.front(), high = low;
  for (std::size_t i = 0; i < tool.heels.size(); ++i)
    for (const Vec3d& end : {tool.heels[i], tool.path[i].position}) {
      low = low.cwiseMin(end);
      high = high.cwiseMax(end);
    }
  return (low.array() <= box.max.array()).all() && (high.array() >= box.min.array()).all();
}

// Whether its first place is inside the body, as long as that lies where it is at rest.
bool begins_inside(const SceneScalpel& tool, const Scene& scene, const TetMesh& mesh) {
  const bool may_have_moved = scene.gravity != Vec3d::Zero() || scene.tools.size() > 1;
  if (may_have_moved && tool.path.front().time > 0) return false;
  const Locator locator(mesh);
  const Vec3d tip = tool.path.front().position, heel = tool.heels.front();
  const auto is_inside = [&](const Vec3d& point) { return locator.nearest(point).distance == 0; };
  return is_inside(tip) && is_inside(heel) && is_inside((tip + heel) / 2);
}

}  // namespace

bool KindOf<SceneScalpel>::read_row(const nlohmann::json& row, SceneScalpel& tool) {
  if (row.size() != (tool.blade ? 4 : 7)) return false;
  tool.heels.push_back(tool.blade ? Vec3d(tool.path.back().position + *tool.blade) : read_vector(row, 4));
  return true;
}

void KindOf<SceneScalpel>::write_row(const SceneScalpel& tool, std::size_t number,
                                     nlohmann::ordered_json& row) {
  const Vec3d& heel = tool.heels[number];
  row.insert(row.end(), {heel[0], heel[1], heel[2]});
}

void KindOf<SceneScalpel>::resolve(Resolution& resolution, SceneScalpel& tool, const std::string& here) {
  for (std::size_t i = 0; i < tool.heels.size(); ++i)
    if (tool.heels[i] == tool.path[i].position)
      resolution.fail(here + "/path/" + std::to_string(i), "tip and heel are the same point");
  tool.along_faces = tool.surface == CutSurface::faces;
  const auto warn = [&](const std::string& text) { resolution.warn(here + "/path", text); };
  const Extent extent = extent_of(tool);
  const double edge = mean_edge(resolution.mesh()), in_a_frame = extent.speed * resolution.scene.time.frame;
  if (extent.longest > 1.05 * extent.shortest)
    warn("the blade's length varies between " + rounded(extent.shortest) + " m and " +
         rounded(extent.longest) + " m: it may turn too far from row to row");
  if (extent.longest < edge)
    warn("the blade is shorter than the mesh's mean edge, " + rounded(edge) + " m: it cuts nothing");
  if (in_a_frame > far_move * edge)
    warn("the blade goes " + rounded(in_a_frame) + " m in a frame, more than three mean edges of " +
         rounded(edge) + " m: it cuts the tissue where that was at the start of the frame");
  if (!comes_near(tool, resolution.mesh()))
    warn("the blade never comes near the mesh");
  else if (begins_inside(tool, resolution.scene, resolution.mesh()))
    resolution.warn(
        here + "/path/0",
        "the blade begins wholly inside the body: what it cuts there is a closed pocket, which opens "
        "nothing. Begin with the heel outside");
}

BringTool KindOf<SceneScalpel>::bring(Resolution&, const SceneScalpel& tool, const std::string&) {
  return BringScalpel{tool.name,
                      {tool.path.front().position, tool.heels.front()},
                      tool.snap,
                      tool.surface == CutSurface::faces};
}

void KindOf<SceneScalpel>::summarise(const ScalpelSetup& setup, nlohmann::ordered_json& entry) {
  entry["surface"] = setup.along_faces ? "faces" : "smooth";
  entry["snap"] = setup.snap;
}

std::string KindOf<SceneScalpel>::describe(const nlohmann::ordered_json& entry) {
  return entry["surface"] == "faces" ? "along faces" : "snap " + rounded(entry["snap"]);
}

SceneScalpel KindOf<SceneScalpel>::from_setup(const ScalpelSetup& setup, Index) {
  return {setup, {}, CutSurface(setup.along_faces)};
}

}  // namespace lobe
