// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/expected_tets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "lobe_mesh/area.h"
#include "lobe_mesh/check_options.h"
#include "lobe_mesh/nearest.h"
#include "lobe_mesh/sizing.h"

namespace lobe::meshing {
namespace {

constexpr int cells_along_box = 16;
constexpr std::size_t most_cells = 100000;
constexpr double most_tets_of_layer = 1e5;

struct BodyCell {
  Vec3d centre;
  double half;  // of its side
};

// Cells that cover the body, of one size.
std::vector<BodyCell> cells_around(const Model& model) {
  const Surface all = joined_surface(model.surfaces);
  const Vec3d low = all.points.rowwise().minCoeff(), high = all.points.rowwise().maxCoeff();
  const double side = (high - low).maxCoeff() / cells_along_box;
  std::vector<BodyCell> cells;
  const Vec3d counts = ((high - low) / side).array().ceil();
  for (int i = 0; i < counts[0]; ++i)
    for (int j = 0; j < counts[1]; ++j)
      for (int k = 0; k < counts[2]; ++k)
        cells.push_back({low + side * (Vec3d(i, j, k).array() + 0.5).matrix(), side / 2});
  return cells;
}

struct Place {
  int region = -1;      // −1: outside
  double distance = 0;  // [m] of the nearest surface
};

// Where a point lies. Lines along x cross the surfaces at triangles. They are moved aside by a little, so
// that none meets an edge of a surface whose coordinates are round.
class Places {
 public:
  explicit Places(const Model& model) : model_(model) {
    const Surface all = joined_surface(model.surfaces);
    aside_ = 1e-7 * (all.points.rowwise().maxCoeff() - all.points.rowwise().minCoeff()).norm();
    for (const Surface& surface : model.surfaces) surfaces_.emplace_back(surface);
  }

  Place operator()(const Vec3d& point) {
    Place place{-1, std::numeric_limits<double>::infinity()};
    for (const NearestPoint& surface : surfaces_)
      place.distance = std::min(place.distance, surface.distance(point));
    if (model_.is_image()) {
      place.region = model_.image_region(point);
      return place;
    }
    const auto [line, is_new] = lines_.try_emplace({point.y(), point.z()});
    if (is_new) line->second = crossings_at(point.y() + 1.9 * aside_, point.z() + 2.3 * aside_);
    for (const auto& [x, region] : line->second)
      if (x < point.x()) place.region = region;
    return place;
  }

 private:
  using Crossings = std::vector<std::pair<double, int>>;  // x [m], region behind it; ascending

  Crossings crossings_at(double y, double z) const {
    Crossings crossings;
    for (std::size_t k = 0; k < model_.surfaces.size(); ++k) {
      const auto& points = model_.surfaces[k].points;
      for (const auto& t : model_.surfaces[k].triangles.colwise()) {
        const Vec3d a = points.col(t[0]), b = points.col(t[1]) - a, c = points.col(t[2]) - a;
        const double across = b.y() * c.z() - b.z() * c.y(), v = y - a.y(), w = z - a.z();
        if (across == 0) continue;
        const double s = (v * c.z() - w * c.y()) / across, u = (b.y() * w - b.z() * v) / across;
        if (s < 0 || u < 0 || s + u > 1) continue;
        const Sides& sides = model_.sides[k];
        crossings.emplace_back(a.x() + s * b.x() + u * c.x(), across > 0 ? sides.outside : sides.inside);
      }
    }
    std::sort(crossings.begin(), crossings.end());
    return crossings;
  }

  const Model& model_;
  double aside_ = 0;  // [m]
  std::vector<NearestPoint> surfaces_;
  std::map<std::pair<double, double>, Crossings> lines_;  // by y and z
};

// Σ V / V_tet(edge) of each region over cells that are divided until edges vary by no more than a quarter
// within each: they grow by `growth` per length. The volumes of the model correct those of the cells.
std::vector<double> tets_of_sizes(const Sizing& sizing, const MeshOptions& options, const Model& model) {
  std::vector<double> volumes(model.labels.size(), 0), tets(model.labels.size(), 0);
  Places place_of(model);
  std::vector<BodyCell> cells = cells_around(model);  // the larger ones first
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [centre, half] = cells[i];
    const Place at = place_of(centre);
    const double radius = std::numbers::sqrt3 * half;
    if (at.region < 0 && at.distance > radius) continue;
    const double edge = sizing(centre, at.region);
    if (std::min(1.0, options.growth) * radius > edge / 4 && cells.size() < most_cells) {
      for (int k = 0; k < 8; ++k)
        cells.push_back(
            {centre + half / 2 * Vec3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1), half / 2});
    } else if (at.region >= 0) {
      const double volume = std::pow(2 * half, 3);
      volumes[std::size_t(at.region)] += volume;
      tets[std::size_t(at.region)] += volume / regular_volume(edge);
    }
  }
  for (std::size_t r = 0; r < tets.size(); ++r) tets[r] *= volumes[r] > 0 ? model.volumes[r] / volumes[r] : 0;
  return tets;
}

// Lines along both rims of a layer are as far apart as it is thick. The refinement takes shorter edges there,
// so that it makes about so many more tetrahedra per edge of these lines (measured on two plates).
constexpr double tets_per_edge_of_line = 10;

double tets_along_lines(const Sizing& sizing, const Model& model) {
  constexpr double most_parts = 1000;
  double edges = 0;
  for (const Mat3X<double>& line : model.junctions)
    for (Eigen::Index i = 0; i + 1 < line.cols(); ++i) {
      const Vec3d step = line.col(i + 1) - line.col(i);
      const auto parts =
          static_cast<int>(std::clamp(std::ceil(step.norm() / sizing.shortest()), 1.0, most_parts));
      for (int part = 0; part < parts; ++part)
        edges += step.norm() / parts / sizing(line.col(i) + (part + 0.5) / parts * step, -1);
    }
  return tets_per_edge_of_line * edges;
}

double edge_of(const MeshOptions& options, const Model& model, int region) {
  if (region < 0) return std::numeric_limits<double>::infinity();
  const auto asked = options.label_edges.find(model.labels[std::size_t(region)]);
  return asked == options.label_edges.end() ? options.edge : asked->second;
}

}  // namespace

double edge_within(const Model& model, int region) {
  double faces = 0;
  for (std::size_t k = 0; k < model.surfaces.size(); ++k)
    if (model.sides[k].inside == region || model.sides[k].outside == region) faces += area(model.surfaces[k]);
  return faces > 0 ? 2 * model.volumes[std::size_t(region)] / faces : 0;
}

bool keeps_few_tets(const Model& model, int region, double edge) {
  return model.volumes[std::size_t(region)] < most_tets_of_layer * regular_volume(edge);
}

// Where a body is thin or has spikes, each face of a region's surface needs about one tetrahedron; a face
// between two regions one on either side.
double expected_tets(const MeshOptions& options, const Model& model) {
  const Sizing sizing(model, options);
  std::vector<double> by_size, by_faces(model.labels.size(), 0);
  if (!sizing.uniform()) by_size = tets_of_sizes(sizing, options, model);
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    const auto [inside, outside] = model.sides[k];
    const double edge = std::min(edge_of(options, model, inside), edge_of(options, model, outside)),
                 faces = area(model.surfaces[k]) / (std::numbers::sqrt3 / 4 * edge * edge);
    for (const int region : {inside, outside})
      if (region >= 0) by_faces[std::size_t(region)] += faces;
  }
  double tets = model.shares_walls() ? tets_along_lines(sizing, model) : 0;
  for (int region = 0; region < model.region_count(); ++region) {
    const auto r = std::size_t(region);
    const double alone = model.volumes[r] / regular_volume(edge_of(options, model, region));
    tets += std::max({by_size.empty() ? 0 : by_size[r], alone, by_faces[r]});
  }
  return tets;
}

MeshOptions with_edges_of_thin_labels(MeshOptions options, const Model& model) {
  for (int region = 0; region < model.region_count(); ++region) {
    const double edge = edge_within(model, region);
    if (edge > 0 && edge < edge_of(options, model, region))
      options.label_edges[model.labels[std::size_t(region)]] = edge;
  }
  return options;
}

}  // namespace lobe::meshing
