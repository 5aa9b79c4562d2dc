#include "lobe/scene/read_shape.h"

#include "lobe/io/surface_io.h"
#include "lobe/scene/json_text.h"

namespace lobe {
namespace {

using namespace nlohmann::literals;

// By extension, as the library without its meshing part reads surfaces.
RigidShape read_shape_file(const std::filesystem::path& file) {
  RigidShape shape{.kind = RigidShape::Kind::mesh};
  if (file.extension() == ".obj") {
    const TexturedSurface surface = read_obj(file);
    for (const auto& p : surface.points.colwise()) shape.points.push_back(p);
    for (const auto& t : surface.triangles.colwise()) shape.triangles.push_back(t);
  } else if (file.extension() == ".vtp") {
    const Polygons polygons = read_vtp(file);
    shape.points = polygons.points;
    for (const auto& corners : polygons.corners)
      for (std::size_t i = 2; i < corners.size(); ++i)
        shape.triangles.emplace_back(int(corners[0]), int(corners[i - 1]), int(corners[i]));
  } else {
    throw InputError(file.string(), "a shape is read from .obj or .vtp");
  }
  return shape;
}

}  // namespace

RigidShape read_shape(const nlohmann::json& entry) {
  const auto only = entry.begin();
  const std::string& kind = only.key();
  const nlohmann::json& values = *only;
  if (kind == "sphere") return RigidShape::sphere(values["radius"]);
  if (kind == "capsule") return RigidShape::capsule(values["radius"], values["length"]);
  if (kind == "box") return RigidShape::box(read_vector(values["size"]));
  if (kind == "plane") return RigidShape::plane();
  if (kind == "jaws") return RigidShape::jaws(read_vector(values["size"]));
  RigidShape mesh{.kind = RigidShape::Kind::mesh};
  if (values.contains("file")) return mesh;
  for (const auto& point : values["points"]) mesh.points.push_back(read_vector(point));
  for (const auto& t : values["triangles"])
    mesh.triangles.emplace_back(t[0].get<int>(), t[1].get<int>(), t[2].get<int>());
  return mesh;
}

std::filesystem::path shape_file(const nlohmann::json& entry) {
  const std::string name = entry.value("/mesh/file"_json_pointer, "");
  return std::u8string(name.begin(), name.end());
}

nlohmann::ordered_json write_shape(const RigidShape& shape, const std::filesystem::path& file) {
  const std::u8string name = file.u8string();
  if (!name.empty()) return {{"mesh", {{"file", std::string(name.begin(), name.end())}}}};
  switch (shape.kind) {
    case RigidShape::Kind::sphere:
      return {{"sphere", {{"radius", shape.radius}}}};
    case RigidShape::Kind::capsule:
      return {{"capsule", {{"radius", shape.radius}, {"length", shape.length}}}};
    case RigidShape::Kind::box:
      return {{"box", {{"size", {shape.size[0], shape.size[1], shape.size[2]}}}}};
    case RigidShape::Kind::jaws:
      return {{"jaws", {{"size", {shape.size[0], shape.size[1], shape.size[2]}}}}};
    case RigidShape::Kind::plane:
      return {{"plane", nlohmann::ordered_json::object()}};
    case RigidShape::Kind::mesh:
      break;
  }
  nlohmann::ordered_json points = nlohmann::ordered_json::array(), triangles = points;
  for (const Vec3d& p : shape.points) points.push_back({p[0], p[1], p[2]});
  for (const Eigen::Vector3i& t : shape.triangles) triangles.push_back({t[0], t[1], t[2]});
  return {{"mesh", {{"points", points}, {"triangles", triangles}}}};
}

std::optional<RigidShape> resolve_shape(Resolution& resolution, const RigidShape& shape,
                                        const std::filesystem::path& file, const std::string& place) {
  const std::size_t before = resolution.faults.size();
  RigidShape found = shape;
  try {
    if (!file.empty()) found = read_shape_file(resolution.scene.file.parent_path() / file);
  } catch (const InputError& error) {
    for (const Fault& fault : error.faults()) resolution.faults.push_back(fault);
    return std::nullopt;
  }
  const Expect expect = [&](bool is_met, const std::string& fault) {
    if (!is_met) resolution.fail(place, fault);
  };
  found.check(expect, "it");
  if (resolution.faults.size() > before) return std::nullopt;
  return found;
}

}  // namespace lobe
