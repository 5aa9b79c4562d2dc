#include "lobe/scene/read_shape.h"

#include "lobe/io/surface_io.h"
#include "lobe/scene/contact_keys.h"

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

std::filesystem::path shape_file(const nlohmann::json& entry) {
  const std::string name = entry.value("/mesh/file"_json_pointer, "");
  return std::u8string(name.begin(), name.end());
}

nlohmann::ordered_json write_shape(const RigidShape& shape, const std::filesystem::path& file) {
  if (file.empty()) return keys::write_value(shape);
  return {{"mesh", {{"file", keys::write_value(file)}}}};
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
