// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/surface.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "lobe_mesh/lines.h"

namespace lobe::meshing {
namespace {

using EdgeLengths = std::map<std::pair<Index, Index>, double>;

// Edges of three triangles or more.
std::set<std::pair<Index, Index>> junctions_of(const Surface& surface) {
  std::map<std::pair<Index, Index>, int> uses;
  for (const auto& t : surface.triangles.colwise())
    for (int k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  std::set<std::pair<Index, Index>> junctions;
  for (const auto& [edge, count] : uses)
    if (count > 2) junctions.insert(edge);
  return junctions;
}

EdgeLengths sharp_edges(const Surface& surface, double angle,
                        const std::set<std::pair<Index, Index>>& junctions) {
  std::map<std::pair<Index, Index>, Vec3d> first_normal;
  EdgeLengths sharp;
  const double limit = std::cos(angle * std::numbers::pi / 180);
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    const auto corner = [&](int k) -> Vec3d { return surface.points.col(surface.triangles(k, t)); };
    const Vec3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    for (int k = 0; k < 3; ++k) {
      const std::pair<Index, Index> edge =
          std::minmax(surface.triangles(k, t), surface.triangles((k + 1) % 3, t));
      const auto [other, is_new] = first_normal.try_emplace(edge, normal);
      if (!is_new && (other->second.dot(normal) < limit || junctions.contains(edge))) {
        sharp[edge] = (surface.points.col(edge.first) - surface.points.col(edge.second)).norm();
      }
    }
  }
  return sharp;
}

// Removes lines that end somewhere (a vertex with one edge) or turn by more than 60° without a branch, but no
// junctions.
void drop_creases(const Surface& surface, const std::set<std::pair<Index, Index>>& junctions,
                  EdgeLengths& edges) {
  for (bool changed = true; changed;) {
    std::map<Index, std::vector<Index>> next;
    for (const auto& [edge, length] : edges) {
      next[edge.first].push_back(edge.second);
      next[edge.second].push_back(edge.first);
    }
    const auto loose = [&](Index v) {
      const std::vector<Index>& around = next[v];
      if (around.size() != 2) return around.size() < 2;
      const Vec3d in = surface.points.col(v) - surface.points.col(around[0]);
      const Vec3d out = surface.points.col(around[1]) - surface.points.col(v);
      return in.dot(out) < 0.5 * in.norm() * out.norm();
    };
    changed =
        std::erase_if(edges, [&](const auto& entry) {
          return !junctions.contains(entry.first) && (loose(entry.first.first) || loose(entry.first.second));
        }) > 0;
  }
}

// Removes connected groups of edges whose total length is below `shortest`.
void drop_short_groups(EdgeLengths& edges, double shortest) {
  std::map<Index, Index> parent;
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [edge, length] : edges) {
    parent.try_emplace(edge.first, edge.first);
    parent.try_emplace(edge.second, edge.second);
  }
  for (const auto& [edge, length] : edges) parent[root(edge.first)] = root(edge.second);
  std::map<Index, double> total;
  for (const auto& [edge, length] : edges) total[root(edge.first)] += length;
  std::erase_if(edges, [&](const auto& entry) { return total[root(entry.first.first)] < shortest; });
}

double length_of(const Surface& surface, const Polyline& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i)
    length += (surface.points.col(line[i]) - surface.points.col(line[i - 1])).norm();
  return length;
}

}  // namespace

double enclosed_volume(const Surface& surface) {
  double six_volumes = 0;
  const Vec3d origin = surface.point_count() > 0 ? Vec3d(surface.points.col(0)) : Vec3d::Zero();
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    const auto corner = [&](int k) -> Vec3d { return surface.points.col(surface.triangles(k, t)) - origin; };
    six_volumes += corner(0).dot(corner(1).cross(corner(2)));
  }
  return six_volumes / 6;
}

double box_diagonal(const Surface& surface) {
  if (surface.triangle_count() == 0) return 0;
  Eigen::AlignedBox3d box;
  for (const Index v : surface.triangles.reshaped()) box.extend(surface.points.col(v));
  return box.diagonal().norm();
}

UnitBox::UnitBox(const Surface& surface) {
  if (surface.triangle_count() == 0) return;
  Eigen::AlignedBox3d box;
  for (const Index v : surface.triangles.reshaped()) box.extend(surface.points.col(v));
  centre = box.center();
  const double diagonal = box.diagonal().norm();
  if (diagonal > 0) size = std::exp2(std::ceil(std::log2(diagonal)));
}

Mat3X<double> UnitBox::to_unit(const Mat3X<double>& points) const {
  return (points.colwise() - centre) / size;
}

Mat3X<double> UnitBox::from_unit(const Mat3X<double>& points) const {
  return (points * size).colwise() + centre;
}

std::vector<Polyline> lines_of(const std::vector<std::pair<Index, Index>>& edges) {
  std::map<Index, std::set<Index>> next;
  for (const auto& [a, b] : edges) {
    next[a].insert(b);
    next[b].insert(a);
  }
  std::set<Index> corners;  // where a line ends: other than two edges meet
  for (const auto& [v, around] : next) {
    if (around.size() != 2) corners.insert(v);
  }
  std::vector<Polyline> lines;
  const auto follow = [&](Index start) {
    Polyline line{start};
    Index v = start;
    do {
      const Index w = *next[v].begin();
      next[v].erase(w);
      next[w].erase(v);
      line.push_back(v = w);
    } while (v != start && !corners.contains(v));
    lines.push_back(std::move(line));
  };
  for (const Index corner : corners) {
    while (!next[corner].empty()) follow(corner);
  }
  for (const auto& [v, around] : next) {
    if (!around.empty()) follow(v);  // what remains are closed loops
  }
  return lines;
}

FeatureLines feature_lines(const Surface& surface, double angle, double shortest, double finest) {
  const auto junctions = junctions_of(surface);
  EdgeLengths edges = sharp_edges(surface, angle, junctions);
  FeatureLines result;
  for (bool changed = true; changed;) {
    drop_creases(surface, junctions, edges);
    drop_short_groups(edges, shortest);
    std::vector<std::pair<Index, Index>> pairs;
    for (const auto& [edge, length] : edges) pairs.push_back(edge);
    result.lines = lines_of(pairs);
    changed = false;
    for (const Polyline& line : result.lines) {
      if (length_of(surface, line) >= finest) continue;
      if (result.fine++ == 0) result.fine_at = surface.points.col(line.front());
      for (std::size_t i = 1; i < line.size(); ++i) edges.erase(std::minmax(line[i - 1], line[i]));
      changed = true;
    }
  }
  return result;
}

}  // namespace lobe::meshing
