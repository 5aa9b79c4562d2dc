// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/surface_gap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lobe_mesh/interfaces.h"

namespace lobe::meshing {
namespace {

constexpr int most_parts = 64;  // into which a side of a triangle is divided
// Edges along a lost part, of its width: single tetrahedra across it may fold over when they are relaxed.
constexpr double across = 0.65;

// The centres of n² equal parts of a triangle.
void add_points(const Mat3<double>& corners, double spacing, const SurfacePoint& of,
                std::vector<SurfacePoint>& points) {
  const Vec3d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0);
  const Vec3d normal = a.cross(b);
  if (!(normal.norm() > 0)) return;
  const double longest = std::max({a.norm(), b.norm(), (b - a).norm()});
  const int n = std::clamp(static_cast<int>(std::ceil(longest / spacing)), 1, most_parts);
  const double area = normal.norm() / 2 / (n * n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const auto add = [&](double s, double t) {
        points.push_back(
            {corners.col(0) + s / n * a + t / n * b, normal.normalized(), area, of.triangle, of.surface});
      };
      add(i + 1 / 3.0, j + 1 / 3.0);
      if (i + j + 1 < n) add(i + 2 / 3.0, j + 2 / 3.0);
    }
}

}  // namespace

std::vector<SurfacePoint> points_on(const Surface& surface, double spacing, std::size_t number) {
  std::vector<SurfacePoint> points;
  for (Index t = 0; t < surface.triangle_count(); ++t) {
    Mat3<double> corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = surface.points.col(surface.triangles(k, t));
    add_points(corners, spacing, {{}, {}, 0, t, number}, points);
  }
  return points;
}

SurfaceGap gap_between(const std::vector<SurfacePoint>& points, const NearestPoint& other) {
  SurfaceGap gap;
  std::vector<std::pair<double, double>> distances;  // and areas
  double area = 0;
  for (const SurfacePoint& at : points) {
    const double distance = other.distance(at.point);
    distances.emplace_back(distance, at.area);
    area += at.area;
    gap.mean += at.area * distance;
    if (distance <= gap.largest) continue;
    gap.largest = distance;
    gap.place = at.point;
  }
  if (!(area > 0)) return gap;
  gap.mean /= area;
  std::sort(distances.begin(), distances.end());
  double below = 0;
  for (const auto& [distance, part] : distances) {
    below += part;
    gap.percentile_95 = distance;
    if (below >= 0.95 * area) break;
  }
  return gap;
}

Surface faces_of_surfaces(const TetMesh& mesh) {
  const std::vector<InterfaceFace> faces = interface_faces(mesh);
  Surface surface{mesh.points, Triangles(3, static_cast<Eigen::Index>(faces.size()))};
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) surface.triangles(k, static_cast<Eigen::Index>(f)) = faces[f].corners[k];
  return surface;
}

// As long as the ball about p − r n touches the surface at p only, the surface is r away from its centre.
double width_at(const SurfacePoint& at, const NearestPoint& surface, double most) {
  constexpr double tolerance = 0.02;
  const auto fits = [&](double radius) {
    return surface.distance(at.point - radius * at.normal) >= (1 - tolerance) * radius;
  };
  double fitting = 0,
         not_fitting = most / 2048;  // a ball beyond the body would fit, too: begin with small ones
  while (fits(not_fitting)) {
    fitting = not_fitting;
    if (fitting >= most / 2) return most;
    not_fitting *= 2;
  }
  for (int i = 0; i < 12; ++i) {
    const double radius = (fitting + not_fitting) / 2;
    (fits(radius) ? fitting : not_fitting) = radius;
  }
  return 2 * fitting;
}

namespace {

// Takes points that are at least a distance apart.
class Apart {
 public:
  explicit Apart(double distance) : distance_(distance) {}

  bool takes(const Vec3d& point) {
    const Cell cell = cell_of(point);
    for (int k = 0; k < 27; ++k)
      for (const Vec3d& other : taken_[{cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1}])
        if ((other - point).norm() < distance_) return false;
    taken_[cell].push_back(point);
    return true;
  }

 private:
  using Cell = std::array<long, 3>;  // of edges as long as the distance
  Cell cell_of(const Vec3d& point) const {
    Cell cell;
    for (int i = 0; i < 3; ++i) cell[std::size_t(i)] = std::lround(std::floor(point[i] / distance_));
    return cell;
  }

  double distance_;
  std::map<Cell, std::vector<Vec3d>> taken_;
};

// At sharp edges of the surface the width is next to nothing: no ball asks for less than a quarter of them.
double shortest_of(const std::vector<SizeBall>& balls) {
  std::vector<double> widths;
  for (const SizeBall& ball : balls) widths.push_back(ball.edge);
  const auto quarter = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 4);
  std::nth_element(widths.begin(), quarter, widths.end());
  return *quarter;
}

}  // namespace

Remedy remedy_for(const std::vector<SurfacePoint>& points, const NearestPoint& surface,
                  const NearestPoint& mesh, double bound, double spacing) {
  Remedy remedy;
  std::vector<const SurfacePoint*> lost;
  for (const SurfacePoint& at : points) {
    if (mesh.distance(at.point) <= bound) continue;
    const double width = width_at(at, surface, bound);
    remedy.balls.push_back({at.point - width / 2 * at.normal, std::max(width / 2, spacing), across * width});
    lost.push_back(&at);
  }
  if (lost.empty()) return remedy;
  const double shortest = shortest_of(remedy.balls);
  for (SizeBall& ball : remedy.balls) ball.edge = std::max(ball.edge, shortest);
  Apart apart(shortest);
  for (const SurfacePoint* at : lost)
    if (apart.takes(at->point)) remedy.seeds.push_back({at->point, at->surface, at->triangle});
  return remedy;
}

}  // namespace lobe::meshing
