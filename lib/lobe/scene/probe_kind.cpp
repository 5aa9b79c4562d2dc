#include "lobe/scene/probe_kind.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "lobe/diagnostics/locate.h"
#include "lobe/fem/transverse_isotropy.h"
#include "lobe/mesh/quality.h"
#include "lobe/scene/read_shape.h"

namespace lobe {
namespace {

// About as long as a step will be: until a wave has crossed the altitude of a tetrahedron [s].
double expected_step(const Resolution& resolution) {
  const Setup& setup = resolution.result.setup;
  double shortest = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Elastic& material = setup.materials[setup.material_of[std::size_t(t)]];
    const double stiffness = std::max(stiffness_across(material), stiffness_along(material));
    const auto heights = altitudes(tet_points(setup.mesh, t));
    const double least = *std::min_element(heights.begin(), heights.end());
    shortest = std::min(shortest, least / std::sqrt(stiffness / material.density));
  }
  return std::min(resolution.scene.time.safety * shortest, resolution.scene.time.frame);
}

// No point of the surface is missed while a probe moves by less than a quarter of its radius in a step.
void warn_of_leaps(Resolution& resolution, const SceneProbe& tool, const std::string& path) {
  double highest = 0;  // [m/s]
  std::size_t row = 0;
  for (std::size_t i = 1; i < tool.path.size(); ++i) {
    const double way = (tool.path[i].position - tool.path[i - 1].position).norm();
    const double speed = way / (tool.path[i].time - tool.path[i - 1].time);
    if (speed > highest) highest = speed, row = i;
  }
  const double most = tool.shape.fineness() / 4;
  if (!resolution.faults.empty() || highest * resolution.scene.time.frame <= most) return;
  if (const double in_a_step = highest * expected_step(resolution); in_a_step > most)
    resolution.warn(path + "/" + std::to_string(row),
                    "the probe goes there at " + rounded(highest) + " m/s, about " + rounded(in_a_step) +
                        " m in a step, more than a quarter of its radius, " + rounded(tool.shape.fineness()) +
                        " m: it may leap into the organ or through it");
}

}  // namespace

void after_reading(const nlohmann::json& entry, SceneProbe& tool) {
  tool.shape_file = shape_file(entry["shape"]);
}

void after_writing(const SceneProbe& tool, nlohmann::ordered_json& entry) {
  entry["shape"] = write_shape(tool.shape, tool.shape_file);
}

// Of jaws, the last number is their opening.
bool KindOf<SceneProbe>::read_row(const nlohmann::json& row, SceneProbe& tool) {
  const std::size_t has_opening = tool.shape.kind == RigidShape::Kind::jaws;
  if (row.size() != 4 + has_opening && row.size() != 8 + has_opening) return false;
  if (row.size() >= 8) read_turn(row, tool.path.back());
  if (has_opening) tool.path.back().opening = row.back();
  return true;
}

void KindOf<SceneProbe>::write_row(const SceneProbe& tool, std::size_t number, nlohmann::ordered_json& row) {
  write_turn(tool.path[number], row);
  if (tool.shape.kind == RigidShape::Kind::jaws) row.push_back(tool.path[number].opening);
}

void KindOf<SceneProbe>::resolve(Resolution& resolution, SceneProbe& tool, const std::string& here) {
  std::optional<RigidShape> found = resolve_shape(resolution, tool.shape, tool.shape_file, here + "/shape");
  if (!found) return;
  tool.shape = *std::move(found);
  const Box box = bounding_box(resolution.mesh());
  const double reach = tool.shape.reach();
  const auto is_near = [&](const PathPoint& row) {
    const Vec3d nearest = row.position.cwiseMax(box.min).cwiseMin(box.max);
    return (row.position - nearest).norm() <= reach;
  };
  if (std::none_of(tool.path.begin(), tool.path.end(), is_near))
    resolution.warn(here + "/path",
                    "no row of it comes within reach of the mesh's bounding box, " + rounded(reach) + " m");
  if (Locator(resolution.mesh()).nearest(tool.path.front().position).distance == 0)
    resolution.warn(here + "/path/0",
                    "the probe begins inside the organ: it pushes at once, or not at all where it touches no "
                    "surface. Begin outside");
  warn_of_leaps(resolution, tool, here + "/path");
}

BringTool KindOf<SceneProbe>::bring(Resolution& resolution, const SceneProbe& tool, const std::string& here) {
  const PathPoint& at = tool.path.front();
  BringProbe probe{tool.name, {}, {at.position, at.orientation}, tool.friction};
  if (tool.shape.kind == RigidShape::Kind::jaws) probe.pose.opening = at.opening;
  if (auto shape = resolve_shape(resolution, tool.shape, tool.shape_file, here + "/shape"))
    probe.shape = *std::move(shape);
  return probe;
}

void KindOf<SceneProbe>::summarise(const ProbeSetup& setup, nlohmann::ordered_json& entry) {
  entry["shape"] = write_shape(setup.shape, {}).begin().key();
  entry["friction"] = setup.friction;
}

std::string KindOf<SceneProbe>::describe(const nlohmann::ordered_json& entry) {
  return entry["shape"].get<std::string>() + ", friction " + rounded(entry["friction"]);
}

}  // namespace lobe
