#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "lobe/diagnostics/locate.h"
#include "lobe/fem/transverse_isotropy.h"
#include "lobe/mesh/quality.h"
#include "lobe/scene/read_shape.h"
#include "lobe/scene/tool_kinds.h"

namespace lobe {
namespace {

void read_probe(const nlohmann::json& entry, Tool& tool) {
  read_keys_of<keys::probe_keys>(entry, tool);
  tool.shape_file = shape_file(entry["shape"]);
}

void write_probe(const Tool& tool, nlohmann::ordered_json& entry) {
  write_keys_of<keys::probe_keys>(tool, entry);
  entry["shape"] = write_shape(tool.shape, tool.shape_file);
}

// Of jaws, the last number is their opening.
bool read_probe_row(const nlohmann::json& row, Tool& tool) {
  const std::size_t has_opening = tool.shape.kind == RigidShape::Kind::jaws;
  if (row.size() != 4 + has_opening && row.size() != 8 + has_opening) return false;
  if (row.size() >= 8)
    for (int i = 0; i < 4; ++i) tool.path.back().orientation[i] = row[std::size_t(4 + i)].get<double>();
  if (has_opening) tool.path.back().opening = row.back();
  return true;
}

void write_probe_row(const Tool& tool, std::size_t number, nlohmann::ordered_json& row) {
  write_turning_row(tool, number, row);
  if (tool.shape.kind == RigidShape::Kind::jaws) row.push_back(tool.path[number].opening);
}

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
void warn_of_leaps(Resolution& resolution, const Tool& tool, const RigidShape& shape,
                   const std::string& path) {
  double highest = 0;  // [m/s]
  std::size_t row = 0;
  for (std::size_t i = 1; i < tool.path.size(); ++i) {
    const double way = (tool.path[i].position - tool.path[i - 1].position).norm();
    const double speed = way / (tool.path[i].time - tool.path[i - 1].time);
    if (speed > highest) highest = speed, row = i;
  }
  const double most = shape.fineness() / 4;
  if (!resolution.faults.empty() || highest * resolution.scene.time.frame <= most) return;
  if (const double in_a_step = highest * expected_step(resolution); in_a_step > most)
    resolution.warn(path + "/" + std::to_string(row),
                    "the probe goes there at " + rounded(highest) + " m/s, about " + rounded(in_a_step) +
                        " m in a step, more than a quarter of its radius, " + rounded(shape.fineness()) +
                        " m: it may leap into the organ or through it");
}

void resolve_probe(Resolution& resolution, const Tool& tool, const std::string& here) {
  const std::optional<RigidShape> found =
      resolve_shape(resolution, tool.shape, tool.shape_file, here + "/shape");
  if (!found) return;
  const RigidShape& shape = *found;
  resolution.result.setup.probes.push_back({tool.name, shape, tool.friction, tool.path, tool.release});
  const Box box = bounding_box(resolution.mesh());
  const double reach = shape.reach();
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
  warn_of_leaps(resolution, tool, shape, here + "/path");
}

BringTool bring_probe(Resolution& resolution, const Tool& tool, const std::string& here) {
  const PathPoint& at = tool.path.front();
  BringProbe probe{tool.name, {}, {at.position, at.orientation}, tool.friction};
  if (tool.shape.kind == RigidShape::Kind::jaws) probe.pose.opening = at.opening;
  if (auto shape = resolve_shape(resolution, tool.shape, tool.shape_file, here + "/shape"))
    probe.shape = *std::move(shape);
  return probe;
}

void summarise_probe(const Setup& setup, std::size_t number, nlohmann::ordered_json& entry) {
  entry["shape"] = write_shape(setup.probes[number].shape, {}).begin().key();
  entry["friction"] = setup.probes[number].friction;
}

void append_probes(const ToolSetups& done, Index, std::vector<Tool>& tools) {
  for (const ProbeSetup& probe : done.probes) {
    Tool& tool = tools.emplace_back();
    tool.name = probe.name;
    tool.type = ProbeSetup::type;
    tool.shape = probe.shape;
    tool.friction = probe.friction;
    tool.path = probe.path;
    tool.release = probe.release;
  }
}

}  // namespace

extern const ToolKind probe_kind;
const ToolKind probe_kind{
    ProbeSetup::type, "4 numbers, or 8 with a quaternion; one more for the opening of jaws",
    read_probe,       write_probe,
    read_probe_row,   write_probe_row,
    resolve_probe,    bring_probe,
    summarise_probe,  append_probes};

}  // namespace lobe
