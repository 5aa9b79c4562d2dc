// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/body_size.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "lobe/error.h"
#include "lobe_mesh/area.h"
#include "lobe_mesh/model.h"

namespace lobe::meshing {
namespace {

using Json = nlohmann::ordered_json;

constexpr double staircase = 1.5;  // area of a ball of voxels over that of the ball

// The smallest surface around another one; −1: none.
int surface_around(const std::vector<Surface>& surfaces, const std::vector<double>& volumes, std::size_t k) {
  const Vec3d point = surfaces[k].points.col(surfaces[k].triangles(0, 0));
  int around = -1;
  for (std::size_t j = 0; j < surfaces.size(); ++j) {
    if (j == k || volumes[j] <= volumes[k] || std::abs(winding_number(surfaces[j], point)) < 0.5) continue;
    if (around < 0 || volumes[j] < volumes[std::size_t(around)]) around = static_cast<int>(j);
  }
  return around;
}

}  // namespace

BodySize size_of(const std::vector<Surface>& surfaces, std::size_t cavities) {
  std::vector<double> volumes;
  Eigen::AlignedBox3d box;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const Surface& surface = surfaces[k];
    volumes.push_back(std::abs(enclosed_volume(surface)));
    if (!(volumes.back() > 0 && std::isfinite(volumes.back())))
      throw InputError("surface " + std::to_string(k), "encloses no volume, or is not finite");
    for (const Index v : surface.triangles.reshaped()) box.extend(Vec3d(surface.points.col(v)));
  }
  BodySize body;
  body.size = box.sizes();
  for (std::size_t k = 0; k < surfaces.size(); ++k) body.parts.push_back({volumes[k], area(surfaces[k])});
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const int around = surface_around(surfaces, volumes, k);
    if (around < 0) continue;
    body.parts[std::size_t(around)].volume -= volumes[k];
    body.parts[std::size_t(around)].area += area(surfaces[k]);
  }
  body.parts.resize(surfaces.size() - cavities);
  return body;
}

BodySize size_of(const LabelImage& image) {
  const Mat3<double> axes = image.to_world.leftCols<3>();
  const double voxel = std::abs(axes.determinant());
  std::map<std::int32_t, BodySize::Part> parts;
  Eigen::AlignedBox3d box;  // its corners are centres of voxels
  const auto value_at = [&](const std::array<Index, 3>& at) {
    for (int axis = 0; axis < 3; ++axis)
      if (at[axis] < 0 || at[axis] >= image.size[axis]) return std::int32_t(0);
    return image.at(at[0], at[1], at[2]);
  };
  for (Index k = 0; k < image.size[2]; ++k)
    for (Index j = 0; j < image.size[1]; ++j)
      for (Index i = 0; i < image.size[0]; ++i) {
        const std::int32_t value = image.at(i, j, k);
        if (value == 0) continue;
        box.extend(Vec3d(i, j, k));
        BodySize::Part& part = parts[value];
        part.volume += voxel;
        for (int axis = 0; axis < 3; ++axis)
          for (const Index step : {-1, 1}) {
            std::array<Index, 3> next{i, j, k};
            next[axis] += step;
            if (value_at(next) == value) continue;
            part.area += axes.col((axis + 1) % 3).cross(axes.col((axis + 2) % 3)).norm() / staircase;
          }
      }
  if (box.isEmpty()) throw InputError("label image", "empty: every voxel is 0, the background");
  BodySize body;
  body.size = (box.sizes().array() + 1) * axes.colwise().norm().transpose().array();
  for (const auto& [value, part] : parts) body.parts.push_back(part);
  return body;
}

std::string in_json(const BodySize& body, double scale) {
  Json parts = Json::array();
  for (const BodySize::Part& part : body.parts)
    parts.push_back({{"volume", part.volume}, {"area", part.area}});
  return Json{{"size", {body.size.x(), body.size.y(), body.size.z()}}, {"scale", scale}, {"parts", parts}}
      .dump(2);
}

}  // namespace lobe::meshing
