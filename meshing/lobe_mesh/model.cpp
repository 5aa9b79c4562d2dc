// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "lobe/error.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/label_grid.h"
#include "lobe_mesh/shared_walls.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

std::string surface_name(std::size_t k, std::size_t count) {
  return count == 1 ? "surface" : "surface " + std::to_string(k);
}

bool touch(const std::vector<Surface>& surfaces) {
  const Surface all = joined_surface(surfaces);
  return !self_intersections({UnitBox(all).to_unit(all.points), all.triangles}, 1).empty();
}

int find_parent(const std::vector<Surface>& surfaces, std::size_t k) {
  int parent = -1;
  for (std::size_t j = 0; j < surfaces.size(); ++j) {
    if (j == k || winding_number(surfaces[j], surfaces[k].points.col(surfaces[k].triangles(0, 0))) < 0.5)
      continue;
    if (parent < 0 || enclosed_volume(surfaces[j]) < enclosed_volume(surfaces[parent]))
      parent = static_cast<int>(j);
  }
  return parent;
}

}  // namespace

int Model::region_of(int label) const {
  const auto found = std::find(labels.begin(), labels.end(), label);
  return found == labels.end() ? -1 : static_cast<int>(found - labels.begin());
}

// Finds the region of a point: the surfaces of a region, seen from its inside, wind once around each of its
// points.
int Model::region_at(const Vec3d& point) const {
  if (is_image()) return image_region(point);
  std::vector<double> winding(labels.size(), 0);
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const double w = winding_number(surfaces[k], point);
    winding[sides[k].inside] += w;
    if (sides[k].outside >= 0) winding[sides[k].outside] -= w;
  }
  const auto most = std::max_element(winding.begin(), winding.end());
  return *most > 0.5 ? static_cast<int>(most - winding.begin()) : -1;
}

double Model::total_volume() const { return std::accumulate(volumes.begin(), volumes.end(), 0.0); }

Model make_model(std::vector<Surface> surfaces, std::size_t cavities) {
  if (cavities >= surfaces.size()) throw InputError("cavities", "need a surface around them");
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const UnitBox unit(surfaces[k]);
    if (!diagnose({unit.to_unit(surfaces[k].points), surfaces[k].triangles}).meshable())
      throw InputError(surface_name(k, surfaces.size()), "not closed and manifold: repair it first");
  }
  if (cavities > 0 || (surfaces.size() > 1 && touch(surfaces)))
    return make_model_of_walls(surfaces, cavities);
  Model model;
  model.surfaces = std::move(surfaces);
  model.features.resize(model.surfaces.size());
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    model.labels.push_back(static_cast<int>(k));
    model.sides.push_back({static_cast<int>(k), find_parent(model.surfaces, k)});
    model.volumes.push_back(enclosed_volume(model.surfaces[k]));
  }
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    if (model.sides[k].outside >= 0)
      model.volumes[model.sides[k].outside] -= enclosed_volume(model.surfaces[k]);
  }
  return model;
}

Model make_model(LabelGrid of_image) {
  const auto grid = std::make_shared<const LabelGrid>(std::move(of_image));
  Model model;
  LabelSurfaces found = label_surfaces(*grid);
  model.surfaces = std::move(found.surfaces);
  model.sides = std::move(found.sides);
  model.junctions = std::move(found.junctions);
  model.features.resize(model.surfaces.size());
  model.labels = grid->values;
  model.volumes = grid->volumes;
  model.warnings = grid->warnings;
  model.image_region = [grid, region = RegionAt(*grid)](const Vec3d& point) { return region(point) - 1; };
  return model;
}

Model make_model(const LabelImage& image, double smoothing) {
  Model model = make_model(make_label_grid(image, smoothing));
  model.warnings.insert(model.warnings.begin(), image.notes.begin(), image.notes.end());
  return model;
}

double winding_number(const Surface& surface, const Vec3d& point) {
  double angle = 0;
  for (const auto& t : surface.triangles.colwise()) {
    const Vec3d a = surface.points.col(t[0]) - point, b = surface.points.col(t[1]) - point,
                c = surface.points.col(t[2]) - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

Surface joined_surface(const std::vector<Surface>& surfaces) {
  Index points = 0, triangles = 0;
  for (const Surface& s : surfaces) points += s.point_count(), triangles += s.triangle_count();
  Surface all;
  all.points.resize(3, points);
  all.triangles.resize(3, triangles);
  points = triangles = 0;
  for (const Surface& s : surfaces) {
    all.points.middleCols(points, s.point_count()) = s.points;
    all.triangles.middleCols(triangles, s.triangle_count()) = s.triangles.array() + points;
    points += s.point_count();
    triangles += s.triangle_count();
  }
  return all;
}

}  // namespace lobe::meshing
