// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/interfaces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace lobe::meshing {
namespace {

// One face of one tetrahedron.
struct Half {
  std::array<Index, 3> key;
  InterfaceFace face;
};

std::vector<Half> all_faces(const TetMesh& mesh) {
  std::vector<Half> halves;
  halves.reserve(4 * static_cast<std::size_t>(mesh.tet_count()));
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (const auto& k : face_corners) {
      const std::array<Index, 3> corners{mesh.tets(k[0], t), mesh.tets(k[1], t), mesh.tets(k[2], t)};
      std::array<Index, 3> key = corners;
      std::sort(key.begin(), key.end());
      halves.push_back({key, {corners, t, mesh.labels.empty() ? 0 : mesh.labels[t], -1}});
    }
  }
  std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
    return std::tie(a.key, a.face.tet) < std::tie(b.key, b.face.tet);
  });
  return halves;
}

const NearestPoint* surface_between(const Interfaces& interfaces, const InterfaceFace& face) {
  const auto found = interfaces.find(std::minmax(face.label, face.other));
  return found == interfaces.end() ? nullptr : found->second;
}

double distance_to_line(const Vec3d& p, const Mat3X<double>& line) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 1; i < line.cols(); ++i) {
    const Vec3d a = line.col(i - 1), along = line.col(i) - a;
    const double s = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (a + s * along - p).norm());
  }
  return nearest;
}

}  // namespace

std::vector<InterfaceFace> interface_faces(const TetMesh& mesh) {
  const std::vector<Half> halves = all_faces(mesh);
  std::vector<InterfaceFace> faces;
  for (std::size_t i = 0; i < halves.size(); ++i) {
    InterfaceFace face = halves[i].face;
    if (i + 1 < halves.size() && halves[i + 1].key == halves[i].key) face.other = halves[++i].face.label;
    if (face.other != face.label) faces.push_back(face);
  }
  return faces;
}

Surface boundary_surface(const TetMesh& mesh) {
  std::vector<Index> corners;
  for (const InterfaceFace& face : interface_faces(mesh)) {
    if (face.other < 0) corners.insert(corners.end(), face.corners.begin(), face.corners.end());
  }
  return {mesh.points, Eigen::Map<const Triangles>(corners.data(), 3, corners.size() / 3)};
}

Freedom find_freedom(const TetMesh& mesh, const Interfaces& interfaces,
                     const std::vector<Mat3X<double>>& features, double on_line) {
  Freedom freedom;
  freedom.slides_on.assign(mesh.vertex_count(), {});
  freedom.is_fixed.assign(mesh.vertex_count(), false);
  for (const InterfaceFace& face : interface_faces(mesh)) {
    const NearestPoint* surface = surface_between(interfaces, face);
    for (const Index v : face.corners) {
      std::vector<const NearestPoint*>& all = freedom.slides_on[v];
      if (surface == nullptr)
        freedom.is_fixed[v] = true;
      else if (std::find(all.begin(), all.end(), surface) == all.end())
        all.push_back(surface);
    }
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (freedom.slides_on[v].empty()) continue;
    const auto near = [&](const Mat3X<double>& line) {
      return distance_to_line(mesh.points.col(v), line) < on_line;
    };
    if (std::any_of(features.begin(), features.end(), near)) freedom.is_fixed[v] = true;
  }
  return freedom;
}

// Projects onto each surface in turn. This converges to the line where the surfaces meet.
Vec3d Freedom::on_surfaces(Index v, const Vec3d& point) const {
  constexpr int rounds = 3;
  Vec3d x = point;
  for (int round = 0; round < (slides_on[v].size() > 1 ? rounds : 1); ++round)
    for (const NearestPoint* surface : slides_on[v]) x = (*surface)(x);
  return x;
}

void restore_volume(TetMesh& mesh, const Interfaces& interfaces, const Freedom& freedom) {
  constexpr double widest_gap = 0.2;  // of a triangle's size: beyond it is another part of the surface
  Mat3X<double> shift = Mat3X<double>::Zero(3, mesh.vertex_count());
  std::vector<double> area_at(mesh.vertex_count(), 0);
  for (const InterfaceFace& face : interface_faces(mesh)) {
    const NearestPoint* surface = surface_between(interfaces, face);
    if (surface == nullptr) continue;
    const Vec3d a = mesh.points.col(face.corners[0]), b = mesh.points.col(face.corners[1]),
                c = mesh.points.col(face.corners[2]);
    const Vec3d normal = (b - a).cross(c - a).normalized(), centre = (a + b + c) / 3;
    const double area = (b - a).cross(c - a).norm() / 2, widest = widest_gap * std::sqrt(area);
    const double gap = normal.dot((*surface)(centre)-centre);
    for (const Index v : face.corners) {
      if (std::abs(gap) < widest) shift.col(v) += area * 0.75 * gap * normal;
      area_at[v] += area;
    }
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (area_at[v] > 0 && !freedom.is_fixed[v] && freedom.slides_on[v].size() == 1)
      mesh.points.col(v) += shift.col(v) / area_at[v];
  }
}

}  // namespace lobe::meshing
