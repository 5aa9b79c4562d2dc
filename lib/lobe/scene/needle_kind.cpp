#include "lobe/scene/needle_kind.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "lobe/diagnostics/locate.h"

namespace lobe {
namespace {

NeedlePose pose_of(const PathPoint& row) {
  return {row.position, Eigen::Quaterniond(row.orientation).normalized().toRotationMatrix()};
}

void check_needle(Resolution& resolution, const NeedleSetup& tool, const std::string& here) {
  const NeedleShape& shape = tool.settings.shape;
  if (!(shape.thickness < shape.radius))
    resolution.fail(here + "/thickness", rounded(shape.thickness) + " m, must be below the radius, " +
                                             rounded(shape.radius) + " m");
  for (std::size_t i = 0; i < tool.ties.size(); ++i)
    if (tool.ties[i].from >= tool.ties[i].to)
      resolution.fail(here + "/ties/" + std::to_string(i) + "/to", "must be a later bite than `from`");
  if (!tool.thread && !tool.ties.empty()) resolution.fail(here + "/ties", "need a `thread`");
  if (!tool.thread) return;
  std::size_t stitches = 0;
  for (const SceneThread& thread : resolution.scene.threads) stitches += thread.stitches.size();
  if (std::size_t(*tool.thread) < stitches)
    resolution.fail(here + "/thread", std::to_string(*tool.thread) + ", must be at least " +
                                          std::to_string(stitches) +
                                          ": stitches of the scene have the numbers below");
}

// The shortest edge of the tetrahedra that are as near to the needle's way as a needle is long.
double shortest_edge_near(const NeedleSetup& tool, const TetMesh& mesh) {
  Eigen::AlignedBox3d way;
  for (const PathPoint& row : tool.path) way.extend(row.position);
  way.min().array() -= 2 * tool.settings.shape.radius;
  way.max().array() += 2 * tool.settings.shape.radius;
  double shortest = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> corners = tet_points(mesh, t);
    if (!way.contains(Vec3d(corners.rowwise().mean()))) continue;
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b) shortest = std::min(shortest, (corners.col(a) - corners.col(b)).norm());
  }
  return shortest;
}

}  // namespace

void KindOf<NeedleSetup>::resolve(Resolution& resolution, NeedleSetup& tool, const std::string& here) {
  check_needle(resolution, tool, here);
  const NeedleShape& shape = tool.settings.shape;
  const Box box = bounding_box(resolution.mesh());
  const auto is_near = [&](const PathPoint& row) {
    const Vec3d nearest = row.position.cwiseMax(box.min).cwiseMin(box.max);
    return (row.position - nearest).norm() <= shape.radius;
  };
  if (std::none_of(tool.path.begin(), tool.path.end(), is_near))
    return resolution.warn(here + "/path",
                           "no row of it comes within the needle's radius of the mesh's bounding box");
  const Vec3d tip = pose_of(tool.path.front()).place(shape, 0);
  if (Locator(resolution.mesh()).nearest(tip).distance == 0)
    resolution.warn(here + "/path/0",
                    "the needle's tip begins inside the organ: it sews nothing until it has come out. Begin "
                    "outside");
  if (const double edge = shortest_edge_near(tool, resolution.mesh()); shape.thickness > edge)
    resolution.warn(here + "/thickness",
                    rounded(shape.thickness) + " m, above the shortest edge there, " + rounded(edge) +
                        " m: a needle is a line without thickness for the tissue, which such a mesh would "
                        "tell apart. Use a coarser mesh");
}

BringTool KindOf<NeedleSetup>::bring(Resolution& resolution, const NeedleSetup& tool,
                                     const std::string& here) {
  check_needle(resolution, tool, here);
  if (!tool.ties.empty()) resolution.fail(here + "/ties", "a hand ties by itself: leave them out");
  const PathPoint& at = tool.path.front();
  return BringNeedle{tool.name,   tool.settings, {at.position, at.orientation},
                     tool.thread, tool.material, tool.thread_length};
}

void KindOf<NeedleSetup>::summarise(const NeedleSetup& setup, nlohmann::ordered_json& entry) {
  entry["length_m"] = setup.settings.shape.length();
  entry["radius_m"] = setup.settings.shape.radius;
  entry["puncture_N"] = setup.settings.puncture;
  if (setup.thread) entry["thread"] = *setup.thread;
}

std::string KindOf<NeedleSetup>::describe(const nlohmann::ordered_json& entry) {
  const std::string words = rounded(entry["length_m"]) + " m on a radius of " + rounded(entry["radius_m"]) +
                            " m, punctures at " + rounded(entry["puncture_N"]) + " N";
  return entry.contains("thread") ? words + ", with thread " + std::to_string(entry["thread"].get<int>())
                                  : words;
}

}  // namespace lobe
