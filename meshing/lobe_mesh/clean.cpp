// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/clean.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace lobe::meshing {
namespace {

// Renumbers points by `target` (point → point it becomes) and drops those that no triangle uses.
Surface renumbered(const Surface& surface, const std::vector<Index>& target, const std::vector<bool>& keep) {
  std::vector<Index> number(surface.point_count(), -1);
  std::vector<Index> old;
  Surface result;
  result.triangles.resize(3, std::count(keep.begin(), keep.end(), true));
  Index t = 0;
  for (Index s = 0; s < surface.triangle_count(); ++s) {
    if (!keep[s]) continue;
    for (int k = 0; k < 3; ++k) {
      const Index v = target[surface.triangles(k, s)];
      if (number[v] < 0) {
        number[v] = static_cast<Index>(old.size());
        old.push_back(v);
      }
      result.triangles(k, t) = number[v];
    }
    ++t;
  }
  result.points.resize(3, old.size());
  for (std::size_t i = 0; i < old.size(); ++i) result.points.col(i) = surface.points.col(old[i]);
  return result;
}

}  // namespace

bool usable(const Vec3d& point) { return point.allFinite() && point.cwiseAbs().maxCoeff() < 1e50; }

bool degenerate(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return !((b - a).cross(c - a).norm() > 1e-14 * longest);
}

std::vector<Index> first_of_equal_points(const Mat3X<double>& points) {
  const auto coordinates = [&](Index i) { return std::array{points(0, i), points(1, i), points(2, i)}; };
  std::vector<Index> order(points.cols());
  std::iota(order.begin(), order.end(), 0);
  std::erase_if(order, [&](Index i) { return !points.col(i).allFinite(); });
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return coordinates(a) < coordinates(b); });
  std::vector<Index> first(points.cols());
  std::iota(first.begin(), first.end(), 0);
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (coordinates(order[i]) == coordinates(order[i - 1])) first[order[i]] = first[order[i - 1]];
  }
  return first;
}

Surface clean(const Surface& surface, CleanReport& report) {
  const std::vector<Index> first = first_of_equal_points(surface.points);
  std::vector<bool> keep(surface.triangle_count(), true), used(surface.point_count(), false);
  std::set<std::array<Index, 3>> seen;
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    std::array<Index, 3> corners;
    for (int k = 0; k < 3; ++k) {
      corners[k] = first[surface.triangles(k, t)];
      used[surface.triangles(k, t)] = true;
    }
    std::sort(corners.begin(), corners.end());
    if (corners[0] == corners[1] || corners[1] == corners[2]) {
      keep[t] = false;
      ++report.repeated;
    } else if (!seen.insert(corners).second) {
      keep[t] = false;
      ++report.duplicates;
    }
  }
  for (Index i = 0; i < surface.point_count(); ++i) {
    if (!used[i])
      ++report.unused;
    else if (first[i] != i)
      ++report.welded;
  }
  return renumbered(surface, first, keep);
}

Index weld_open_edges(Surface& surface, double tolerance) {
  std::map<std::pair<Index, Index>, int> edges;
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax({surface.triangles(k, t), surface.triangles((k + 1) % 3, t)});
      ++edges[{a, b}];
    }
  }
  std::set<Index> open;
  for (const auto& [edge, count] : edges) {
    if (count == 1) open.insert({edge.first, edge.second});
  }
  using Cell = std::array<long long, 3>;
  std::map<Cell, std::vector<Index>> grid;
  std::vector<Index> target(surface.point_count());
  std::iota(target.begin(), target.end(), 0);
  Index welded = 0;
  for (const Index v : open) {
    const Vec3d p = surface.points.col(v);
    const auto cell = [&](int k, int shift) { return std::llround(std::floor(p[k] / tolerance)) + shift; };
    for (int n = 0; n < 27 && target[v] == v; ++n) {
      const auto found = grid.find({cell(0, n % 3 - 1), cell(1, n / 3 % 3 - 1), cell(2, n / 9 - 1)});
      if (found == grid.end()) continue;
      for (const Index w : found->second) {
        if ((surface.points.col(w) - p).norm() <= tolerance && !edges.contains(std::minmax(v, w))) {
          target[v] = w;
          ++welded;
          break;
        }
      }
    }
    if (target[v] == v) grid[{cell(0, 0), cell(1, 0), cell(2, 0)}].push_back(v);
  }
  if (welded > 0) surface = renumbered(surface, target, std::vector<bool>(surface.triangle_count(), true));
  return welded;
}

}  // namespace lobe::meshing
