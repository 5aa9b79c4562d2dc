// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/voxels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lobe/error.h"
#include "lobe/text.h"
#include "lobe_mesh/mesh_model.h"

namespace lobe::meshing {
namespace {

constexpr double most_voxels = 5e8;

// Lines along x through the centres of the voxels cross a surface at triangles. They are moved aside by a
// little, so that none meets an edge of a surface whose coordinates are round.
constexpr double aside[2] = {1.9e-5, 2.3e-5};  // of a voxel, along y and z

class Voxeliser {
 public:
  Voxeliser(const std::vector<Surface>& surfaces, double edge) : edge_(edge) {
    const Surface all = joined_surface(surfaces);
    low_ = all.points.rowwise().minCoeff().array() - edge;
    const Vec3d extent = all.points.rowwise().maxCoeff() - low_;
    const Vec3d count = (extent.array() / edge).ceil() + 1;
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

  // Gives a value to the voxels that a surface encloses. Returns how many had another that was not 0.
  std::size_t add(const Surface& surface, std::int32_t value) {
    crossings_.assign(std::size_t(image_.size[1]) * std::size_t(image_.size[2]), {});
    for (const auto& t : surface.triangles.colwise()) {
      Mat3<double> corners;  // in voxels, from the first centre
      for (int k = 0; k < 3; ++k)
        corners.col(k) = (surface.points.col(t[k]) - image_.to_world.col(3)) / edge_;
      cross(corners);
    }
    std::size_t taken = 0;
    for (std::size_t line = 0; line < crossings_.size(); ++line) taken += fill(line, value);
    return taken;
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

  std::size_t fill(std::size_t line, std::int32_t value) {
    std::vector<Crossing>& along = crossings_[line];
    std::sort(along.begin(), along.end(), [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    int winding = 0;
    std::size_t taken = 0;
    for (std::size_t n = 0; n + 1 < along.size(); ++n) {
      winding += along[n].entering;
      if (winding < 1) continue;
      const auto first = std::max<Index>(0, static_cast<Index>(std::ceil(along[n].x)));
      for (Index i = first; i < image_.size[0] && i < along[n + 1].x; ++i) {
        std::int32_t& voxel = image_.values[line * std::size_t(image_.size[0]) + std::size_t(i)];
        if (voxel != 0 && voxel != value) ++taken;
        voxel = value;
      }
    }
    return taken;
  }

  double edge_;
  Vec3d low_;
  LabelImage image_;
  std::vector<std::vector<Crossing>> crossings_;  // of each line
};

}  // namespace

LabelImage voxelise(const std::vector<Surface>& surfaces, double edge, std::size_t cavities, Winner winner) {
  if (!(std::isfinite(edge) && edge > 0)) throw InputError("--voxels", "must be a positive number");
  const std::size_t regions = surfaces.size() - cavities;
  std::vector<std::size_t> order(surfaces.size());
  std::iota(order.begin(), order.end(), 0);
  if (winner == Winner::smaller) {
    std::vector<double> volumes;
    for (const Surface& surface : surfaces) volumes.push_back(enclosed_volume(surface));
    std::stable_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(regions),
                     [&](std::size_t a, std::size_t b) { return volumes[a] > volumes[b]; });
  }
  Voxeliser voxeliser(surfaces, edge);
  for (const std::size_t k : order) {
    const std::size_t taken = voxeliser.add(surfaces[k], k < regions ? static_cast<std::int32_t>(k) + 1 : 0);
    if (k >= regions && taken == 0)
      throw InputError("cavity " + std::to_string(k - regions) + " (--void)",
                       "takes no voxel of " + rounded(edge) +
                           " m from what is meshed: it lies outside of it, or is too small");
  }
  LabelImage image = voxeliser.take();
  for (std::size_t k = 0; k < regions; ++k)
    if (std::find(image.values.begin(), image.values.end(), static_cast<std::int32_t>(k) + 1) ==
        image.values.end())
      throw InputError("surface " + std::to_string(k),
                       "has no voxel of " + rounded(edge) +
                           " m of its own: other surfaces or cavities cover it, or it is too small; choose a "
                           "shorter --voxels, or another order");
  return image;
}

TetMesh tetrahedralise_voxels(const std::vector<Surface>& surfaces, double voxel, const MeshOptions& options,
                              MeshReport& report, Winner winner) {
  Model model = make_model(voxelise(surfaces, voxel, options.cavities, winner), options.smoothing);
  for (int& label : model.labels) --label;
  return mesh_model(model, options, report);
}

}  // namespace lobe::meshing
