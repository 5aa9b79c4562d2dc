// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/voxels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "lobe/error.h"
#include "lobe/text.h"
#include "lobe_mesh/area.h"
#include "lobe_mesh/label_grid.h"
#include "lobe_mesh/mesh_model.h"

namespace lobe::meshing {
namespace {

constexpr double most_voxels = 5e8;
constexpr double most_tried_voxels = 2e7;  // where it is only tried how much they keep
constexpr double next_tried = 0.75;        // edge of the next voxels, of those that lose too much
constexpr double kept_share = 1 - quality_gate.lost_volume / 100;

// Lines along x through the centres of the voxels cross a surface at triangles. They are moved aside by a
// little, so that none meets an edge of a surface whose coordinates are round.
constexpr double aside[2] = {1.9e-5, 2.3e-5};  // of a voxel, along y and z

// How many voxels cover surfaces along each axis, with a margin.
Vec3d counts_along(const Surface& all, double edge) {
  const Vec3d extent = all.points.rowwise().maxCoeff() - all.points.rowwise().minCoeff();
  return ((extent.array() + edge) / edge).ceil() + 1;
}

class Voxeliser {
 public:
  Voxeliser(const std::vector<Surface>& surfaces, double edge) : edge_(edge) {
    const Surface all = joined_surface(surfaces);
    low_ = all.points.rowwise().minCoeff().array() - edge;
    const Vec3d count = counts_along(all, edge);
    if (!(count.prod() <= most_voxels))
      throw InputError("--voxels", rounded(edge) +
                                       " m would give more than half a billion voxels: choose at least " +
                                       rounded(1.05 * edge * std::cbrt(count.prod() / most_voxels)) +
                                       " m (or --scale, if the units are wrong)");
    image_.is_of_surfaces = true;
    for (int i = 0; i < 3; ++i) image_.size[std::size_t(i)] = static_cast<Index>(count[i]);
    image_.values.assign(static_cast<std::size_t>(count.prod()), 0);
    image_.to_world.leftCols<3>() = edge * Mat3<double>::Identity();
    image_.to_world.col(3) = low_.array() + edge / 2;
  }

  // Voxels that a surface encloses.
  struct Enclosed {
    std::size_t all = 0;
    std::size_t taken = 0;  // those that had another value that was not 0
  };

  // Gives a value to the voxels that a surface encloses.
  Enclosed add(const Surface& surface, std::int32_t value) {
    crossings_.assign(std::size_t(image_.size[1]) * std::size_t(image_.size[2]), {});
    for (const auto& t : surface.triangles.colwise()) {
      Mat3<double> corners;  // in voxels, from the first centre
      for (int k = 0; k < 3; ++k)
        corners.col(k) = (surface.points.col(t[k]) - image_.to_world.col(3)) / edge_;
      cross(corners);
    }
    Enclosed enclosed;
    for (std::size_t line = 0; line < crossings_.size(); ++line) fill(line, value, enclosed);
    return enclosed;
  }

  LabelImage take() { return std::move(image_); }

 private:
  struct Crossing {
    double x = 0;      // [voxels]
    int entering = 0;  // 1: the line enters the surface, −1: it leaves
  };

  // Adds the crossings of one triangle with all lines.
  void cross(const Mat3<double>& corners) {
    const Vec3d a = corners.col(0), b = corners.col(1) - a, c = corners.col(2) - a;
    const double across = b.y() * c.z() - b.z() * c.y();  // x of the normal
    if (across == 0) return;
    const auto range = [&](int axis) {
      const auto row = corners.row(axis);
      return std::pair(
          std::max<Index>(0, static_cast<Index>(std::floor(row.minCoeff()))),
          std::min(image_.size[std::size_t(axis)] - 1, static_cast<Index>(std::ceil(row.maxCoeff()))));
    };
    const auto [first_j, last_j] = range(1);
    const auto [first_k, last_k] = range(2);
    for (Index k = first_k; k <= last_k; ++k)
      for (Index j = first_j; j <= last_j; ++j) {
        const double y = j + aside[0] - a.y(), z = k + aside[1] - a.z();
        const double s = (y * c.z() - z * c.y()) / across, t = (b.y() * z - b.z() * y) / across;
        if (s < 0 || t < 0 || s + t > 1) continue;
        crossings_[std::size_t(k) * std::size_t(image_.size[1]) + std::size_t(j)].push_back(
            {a.x() + s * b.x() + t * c.x(), across < 0 ? 1 : -1});
      }
  }

  void fill(std::size_t line, std::int32_t value, Enclosed& enclosed) {
    std::vector<Crossing>& along = crossings_[line];
    std::sort(along.begin(), along.end(), [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    int winding = 0;
    for (std::size_t n = 0; n + 1 < along.size(); ++n) {
      winding += along[n].entering;
      if (winding < 1) continue;
      const auto first = std::max<Index>(0, static_cast<Index>(std::ceil(along[n].x)));
      for (Index i = first; i < image_.size[0] && i < along[n + 1].x; ++i) {
        std::int32_t& voxel = image_.values[line * std::size_t(image_.size[0]) + std::size_t(i)];
        ++enclosed.all;
        if (voxel != 0 && voxel != value) ++enclosed.taken;
        voxel = value;
      }
    }
  }

  double edge_;
  Vec3d low_;
  LabelImage image_;
  std::vector<std::vector<Crossing>> crossings_;  // of each line
};

// Surfaces as voxels, and for each surface how many voxels it encloses and how many of these it keeps.
struct Filled {
  LabelImage image;
  std::vector<std::size_t> enclosed, own;
};

// In which order surfaces take voxels: the last one wins.
std::vector<std::size_t> order_of(const std::vector<Surface>& surfaces, std::size_t regions, Winner winner) {
  std::vector<std::size_t> order(surfaces.size());
  std::iota(order.begin(), order.end(), 0);
  if (winner == Winner::later) return order;
  std::vector<double> volumes;
  for (const Surface& surface : surfaces) volumes.push_back(enclosed_volume(surface));
  std::stable_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(regions),
                   [&](std::size_t a, std::size_t b) { return volumes[a] > volumes[b]; });
  return order;
}

Filled fill(const std::vector<Surface>& surfaces, double edge, std::size_t cavities, Winner winner) {
  if (!(std::isfinite(edge) && edge > 0)) throw InputError("--voxels", "must be a positive number");
  const std::size_t regions = surfaces.size() - cavities;
  Filled filled{{}, std::vector<std::size_t>(regions, 0), std::vector<std::size_t>(regions, 0)};
  Voxeliser voxeliser(surfaces, edge);
  for (const std::size_t k : order_of(surfaces, regions, winner)) {
    const auto enclosed = voxeliser.add(surfaces[k], k < regions ? static_cast<std::int32_t>(k) + 1 : 0);
    if (k < regions) filled.enclosed[k] = enclosed.all;
    if (k >= regions && enclosed.taken == 0)
      throw InputError("cavity " + std::to_string(k - regions) + " (--void)",
                       "takes no voxel of " + rounded(edge) +
                           " m from what is meshed: it lies outside of it, or is too small");
  }
  filled.image = voxeliser.take();
  for (const std::int32_t value : filled.image.values)
    if (value > 0) ++filled.own[std::size_t(value) - 1];
  for (std::size_t k = 0; k < regions; ++k) {
    const double share = filled.enclosed[k] == 0 ? 1 : double(filled.own[k]) / double(filled.enclosed[k]);
    filled.image.surface_volumes.push_back(share * enclosed_volume(surfaces[k]));
  }
  return filled;
}

// `may_miss`: whether a surface may have no voxel at its place.
void refuse_without_voxels(const Filled& filled, double edge, bool may_miss) {
  for (std::size_t k = 0; k < filled.own.size(); ++k) {
    const bool is_missed = filled.enclosed[k] == 0;
    if (filled.own[k] > 0 || (is_missed && may_miss)) continue;
    throw InputError("surface " + std::to_string(k),
                     "has no voxel of " + rounded(edge) + " m of its own: " +
                         (is_missed ? "it is too small or too thin; choose a shorter --voxels"
                                    : "other surfaces or cavities cover it; choose another order, or a "
                                      "shorter --voxels"));
  }
}

// What is left of surfaces by voxels and their smoothing.
struct Kept {
  std::optional<LabelGrid> grid;  // none: a surface has no voxel
  std::size_t surface = 0;        // that which keeps least,
  double share = 1;               // and its share
};

Kept kept_by(const Filled& filled, double smoothing) {
  Kept kept;
  const auto missed = std::find(filled.own.begin(), filled.own.end(), std::size_t(0));
  if (missed != filled.own.end()) {
    kept.surface = std::size_t(missed - filled.own.begin());
    kept.share = 0;
    return kept;
  }
  kept.grid = make_label_grid(filled.image, smoothing);
  for (std::size_t r = 0; r < kept.grid->kept.size(); ++r) {
    if (kept.grid->kept[r] >= kept.share) continue;
    kept.surface = std::size_t(kept.grid->values[r]) - 1;
    kept.share = kept.grid->kept[r];
  }
  return kept;
}

// To two digits, downwards.
double two_digits_of(double edge) {
  const double digit = std::pow(10.0, std::floor(std::log10(edge)) - 1);
  return std::floor(edge / digit * (1 + 1e-9)) * digit;
}

// No mesh of these voxels has the volume of a surface of which they are far off.
void expect_what_is_there(LabelGrid& grid) {
  for (std::size_t r = 0; r < grid.kept.size(); ++r)
    if (grid.kept[r] < kept_share || grid.kept[r] > 1 / kept_share) grid.volumes[r] *= grid.kept[r];
}

std::string words_of_loss(const std::vector<Surface>& surfaces, double voxel, const MeshOptions& options,
                          const Kept& kept, Winner winner) {
  const double keeping =
      voxels_that_keep(surfaces, next_tried * voxel, options.cavities, winner, options.smoothing);
  return "voxels of " + rounded(voxel) + " m lose " +
         (kept.share == 0 ? "all" : rounded(std::round(100 * (1 - kept.share))) + " %") +
         " of its volume, since they are coarse for what is thin in it: " +
         (keeping > 0 ? "--voxels " + rounded(keeping) + " keeps it"
                      : "choose a shorter --voxels, or a smaller --smoothing");
}

}  // namespace

LabelImage voxelise(const std::vector<Surface>& surfaces, double edge, std::size_t cavities, Winner winner) {
  Filled filled = fill(surfaces, edge, cavities, winner);
  refuse_without_voxels(filled, edge, false);
  return std::move(filled.image);
}

double voxels_that_keep(const std::vector<Surface>& surfaces, double longest, std::size_t cavities,
                        Winner winner, double smoothing) {
  const Surface all = joined_surface(surfaces);
  double thickness = std::numeric_limits<double>::infinity();  // of a thin wall
  for (std::size_t k = 0; k + cavities < surfaces.size(); ++k)
    thickness = std::min(thickness, 2 * enclosed_volume(surfaces[k]) / area(surfaces[k]));
  if (!(thickness > 0)) return 0;
  for (double edge = longest; counts_along(all, edge).prod() <= most_tried_voxels;
       edge = two_digits_of(std::min(next_tried * edge, thickness / 2)))
    if (kept_by(fill(surfaces, edge, cavities, winner), smoothing).share >= kept_share) return edge;
  return 0;
}

TetMesh tetrahedralise_voxels(const std::vector<Surface>& surfaces, double voxel, const MeshOptions& options,
                              MeshReport& report, Winner winner) {
  const Filled filled = fill(surfaces, voxel, options.cavities, winner);
  refuse_without_voxels(filled, voxel, true);
  Kept kept = kept_by(filled, options.smoothing);
  std::string loss;
  if (kept.share < kept_share) {
    const std::string place = "surface " + std::to_string(kept.surface);
    loss = words_of_loss(surfaces, voxel, options, kept, winner);
    if (kept.share == 0) throw InputError(place, loss);
    if (!options.accepts_loss) throw InputError(place, loss + " (--accept-loss meshes what is left)");
    loss = place + ": " + loss;
  }
  expect_what_is_there(*kept.grid);
  Model model = make_model(std::move(*kept.grid));
  if (!loss.empty()) model.warnings.push_back(loss);
  for (int& label : model.labels) --label;
  return mesh_model(model, options, report);
}

}  // namespace lobe::meshing
