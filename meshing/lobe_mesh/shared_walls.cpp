// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/shared_walls.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "lobe/error.h"
#include "lobe/text.h"
#include "lobe_mesh/disjoint_sets.h"
#include "lobe_mesh/lines.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

constexpr double same_point = 1e-6;  // of the diagonal

using Corners = std::array<Index, 3>;
using Edge = std::pair<Index, Index>;

// For each point the first one within a distance of it.
std::vector<Index> first_of_near_points(const Mat3X<double>& points, double distance) {
  std::vector<Index> order(std::size_t(points.cols())), first(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::iota(first.begin(), first.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return std::pair(points(0, a), a) < std::pair(points(0, b), b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Index a = order[i], b = order[j];
      if (points(0, b) - points(0, a) > distance) break;
      if ((points.col(a) - points.col(b)).norm() > distance) continue;
      Index& of_a = first[std::size_t(a)];
      Index& of_b = first[std::size_t(b)];
      of_a = of_b = std::min(of_a, of_b);
    }
  return first;
}

// A triangle of one surface or more.
struct Wall {
  Corners corners{};                             // counter-clockwise seen from outside of the first
  std::vector<std::pair<std::size_t, bool>> of;  // surfaces; whether it is turned over in them
};

// Starts with the lowest corner.
Corners rotated(const Corners& c) {
  const auto low = std::min_element(c.begin(), c.end()) - c.begin();
  return {c[std::size_t(low)], c[std::size_t(low + 1) % 3], c[std::size_t(low + 2) % 3]};
}

class Walls {
 public:
  Walls(const std::vector<Surface>& surfaces, std::size_t cavities)
      : surfaces_(surfaces),
        all_(joined_surface(surfaces)),
        regions_(surfaces.size() - cavities),
        takes_(cavities) {
    const std::vector<Index> first = first_of_near_points(all_.points, same_point * box_diagonal(all_));
    for (Index& v : all_.triangles.reshaped()) v = first[std::size_t(v)];
    collect();
    refuse_intersections();
    for (const Surface& surface : surfaces) volumes_.push_back(enclosed_volume(surface));
    find_sides();
  }

  Model model() const {
    Model model;
    model.labels.resize(regions_);
    std::iota(model.labels.begin(), model.labels.end(), 0);
    model.volumes = volumes_of_regions();
    std::map<Edge, std::vector<Corners>> patches;  // between the regions outside and inside
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      const auto [outside, inside] = std::minmax(sides_[w].inside, sides_[w].outside);
      Corners c = walls_[w].corners;
      if (sides_[w].inside != inside) std::swap(c[1], c[2]);
      if (inside != outside) patches[{outside, inside}].push_back(c);
    }
    for (const auto& [sides, triangles] : patches) {
      model.surfaces.push_back(patch_of(triangles));
      model.sides.push_back({sides.second, sides.first});
    }
    model.features.resize(model.surfaces.size());
    for (const Polyline& line : lines_of(junctions()))
      model.junctions.emplace_back(all_.points(Eigen::all, line));
    return model;
  }

 private:
  void collect() {
    std::map<Corners, std::size_t> number;
    std::size_t surface = 0;
    for (Index t = 0, last = surfaces_[0].triangle_count(); t < all_.triangle_count(); ++t) {
      while (t >= last) last += surfaces_[++surface].triangle_count();
      const Corners corners = rotated({all_.triangles(0, t), all_.triangles(1, t), all_.triangles(2, t)});
      const Corners turned{corners[0], corners[2], corners[1]};
      const auto [entry, is_new] = number.try_emplace(std::min(corners, turned), walls_.size());
      if (is_new) walls_.push_back({corners, {}});
      Wall& wall = walls_[entry->second];
      wall.of.emplace_back(surface, wall.corners != corners);
    }
  }

  // About where two walls meet: in the middle of what the boxes around them share.
  Vec3d place_of(const Wall& a, const Wall& b) const {
    const Mat3<double> x = points_of(a), y = points_of(b);
    const Vec3d low = x.rowwise().minCoeff().cwiseMax(y.rowwise().minCoeff()),
                high = x.rowwise().maxCoeff().cwiseMin(y.rowwise().maxCoeff());
    return (low + high) / 2;
  }

  void refuse_intersections() const {
    Surface once{all_.points, Triangles(3, walls_.size())};
    for (std::size_t w = 0; w < walls_.size(); ++w)
      once.triangles.col(Eigen::Index(w)) = Eigen::Map<const Eigen::Array3i>(walls_[w].corners.data());
    const UnitBox unit(once);
    const auto pairs = self_intersections({unit.to_unit(once.points), once.triangles});
    if (pairs.empty()) return;
    const Wall &a = walls_[std::size_t(pairs[0].first)], &b = walls_[std::size_t(pairs[0].second)];
    const Vec3d p = place_of(a, b);
    const auto [first, second] = std::minmax(a.of[0].first, b.of[0].first);
    throw SurfacesTouch(
        "surfaces " + std::to_string(first) + " and " + std::to_string(second),
        "touch or intersect near (" + rounded(p.x()) + ", " + rounded(p.y()) + ", " + rounded(p.z()) +
            ") m: one must lie inside the other or apart from it, or they must have the same triangles where "
            "they touch; --voxels EDGE meshes surfaces that share other walls or overlap");
  }

  // Walls at each edge.
  std::map<Edge, std::vector<std::size_t>> at_edges() const {
    std::map<Edge, std::vector<std::size_t>> at;
    for (std::size_t w = 0; w < walls_.size(); ++w)
      for (std::size_t k = 0; k < 3; ++k)
        at[std::minmax(walls_[w].corners[k], walls_[w].corners[(k + 1) % 3])].push_back(w);
    return at;
  }

  // Walls of the same surfaces that meet at an edge without others have the same regions on either side.
  void find_sides() {
    DisjointSets pieces(walls_.size());
    for (const auto& [edge, walls] : at_edges())
      if (walls.size() == 2 && walls_[walls[0]].of == walls_[walls[1]].of)
        pieces.join(Index(walls[0]), Index(walls[1]));
    std::map<Index, std::size_t> largest;  // of each piece
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      const auto [entry, is_new] = largest.try_emplace(pieces.root(Index(w)), w);
      if (!is_new && area(w) > area(entry->second)) entry->second = w;
    }
    std::map<Index, Sides> of_piece;
    for (const auto& [piece, w] : largest) of_piece[piece] = sides_of(walls_[w]);
    for (std::size_t w = 0; w < walls_.size(); ++w) sides_.push_back(of_piece.at(pieces.root(Index(w))));
    for (std::size_t c = 0; c < takes_.size(); ++c)
      if (!takes_[c])
        throw InputError("cavity " + std::to_string(c) + " (--void)",
                         "takes no space from what is meshed: it lies outside of it, or around it");
  }

  Mat3<double> points_of(const Wall& wall) const {
    Mat3<double> points;
    for (int k = 0; k < 3; ++k) points.col(k) = all_.points.col(wall.corners[std::size_t(k)]);
    return points;
  }
  double area(std::size_t w) const {
    const Mat3<double> x = points_of(walls_[w]);
    return (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm() / 2;
  }

  // The regions behind a wall, as seen from outside of its first surface, and before it. Notes which cavities
  // take space from a region.
  Sides sides_of(const Wall& wall) {
    const Vec3d centre = points_of(wall).rowwise().mean();
    std::array<int, 2> found{-1, -1};
    std::array<bool, 2> is_in_region{};
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      const auto owner =
          std::find_if(wall.of.begin(), wall.of.end(), [&](const auto& entry) { return entry.first == s; });
      std::array<bool, 2> encloses{};
      if (owner != wall.of.end())
        encloses = {!owner->second, owner->second};
      else
        encloses[0] = encloses[1] = winding_number(surfaces_[s], centre) > 0.5;
      for (std::size_t side = 0; side < 2; ++side) {
        int& best = found[side];
        is_in_region[side] |= encloses[side] && s < regions_;
        if (encloses[side] && (best < 0 || volumes_[s] < volumes_[std::size_t(best)]))
          best = static_cast<int>(s);
      }
    }
    for (std::size_t side = 0; side < 2; ++side) {
      if (found[side] < static_cast<int>(regions_)) continue;
      if (is_in_region[side]) takes_[std::size_t(found[side]) - regions_] = true;  // a cavity
      found[side] = -1;
    }
    return {found[0], found[1]};
  }

  std::vector<double> volumes_of_regions() const {
    std::vector<double> volumes(regions_, 0);
    const Vec3d origin = all_.points.rowwise().mean();
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      const Mat3<double> x = points_of(walls_[w]).colwise() - origin;
      const double part = x.determinant() / 6;
      if (sides_[w].inside >= 0) volumes[std::size_t(sides_[w].inside)] += part;
      if (sides_[w].outside >= 0) volumes[std::size_t(sides_[w].outside)] -= part;
    }
    for (std::size_t r = 0; r < regions_; ++r)
      if (!(volumes[r] > 1e-9 * volumes_[r]))
        throw InputError("surface " + std::to_string(r),
                         "has no space of its own: another surface or a cavity takes all that it encloses");
    return volumes;
  }

  Surface patch_of(const std::vector<Corners>& triangles) const {
    std::vector<Index> used;
    for (const Corners& c : triangles) used.insert(used.end(), c.begin(), c.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    Surface patch{all_.points(Eigen::all, used), Triangles(3, triangles.size())};
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        patch.triangles(Eigen::Index(k), Eigen::Index(t)) =
            static_cast<Index>(std::lower_bound(used.begin(), used.end(), triangles[t][k]) - used.begin());
    return patch;
  }

  // Edges where more than two walls meet, of those that separate regions.
  std::vector<Edge> junctions() const {
    std::vector<Edge> edges;
    for (const auto& [edge, walls] : at_edges()) {
      const auto separates = [&](std::size_t w) { return sides_[w].inside != sides_[w].outside; };
      if (std::count_if(walls.begin(), walls.end(), separates) > 2) edges.push_back(edge);
    }
    return edges;
  }

  const std::vector<Surface>& surfaces_;
  Surface all_;  // with points that are the same in several surfaces
  std::size_t regions_;
  std::vector<bool> takes_;  // whether each cavity takes space from a region
  std::vector<Wall> walls_;
  std::vector<Sides> sides_;     // of each wall
  std::vector<double> volumes_;  // that each surface encloses
};

}  // namespace

Model make_model_of_walls(const std::vector<Surface>& surfaces, std::size_t cavities) {
  return Walls(surfaces, cavities).model();
}

}  // namespace lobe::meshing
