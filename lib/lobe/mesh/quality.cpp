#include "lobe/mesh/quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lobe {
namespace {

// Outward, twice the area of the face opposite to corner k.
Vec3d face_normal(const Mat34<double>& corners, int k) {
  const auto& [a, b, c] = face_corners[k];
  const Vec3d ab = corners.col(b) - corners.col(a), ac = corners.col(c) - corners.col(a);
  return ab.cross(ac);
}

double longest_edge(const Mat34<double>& corners) {
  double longest = 0;
  for (const auto& [a, b] : edge_corners)
    longest = std::max(longest, (corners.col(a) - corners.col(b)).norm());
  return longest;
}

struct Sums {
  double edges = 0;
  std::vector<double> smallest_dihedrals;
};

void add_angles(const Mat34<double>& corners, Quality& quality, Sums& sums) {
  const auto angles = dihedral_angles(corners);
  for (const double angle : angles) {
    const int bin = std::isfinite(angle) ? std::clamp(static_cast<int>(angle / 10), 0, 17) : 0;
    ++quality.dihedral_histogram[static_cast<std::size_t>(bin)];
  }
  const auto [low, high] = std::minmax_element(angles.begin(), angles.end());
  quality.min_dihedral = std::min(quality.min_dihedral, *low);
  quality.max_dihedral = std::max(quality.max_dihedral, *high);
  sums.smallest_dihedrals.push_back(*low);
}

void add_lengths(const Mat34<double>& corners, Index tet, Quality& quality, Sums& sums) {
  const auto heights = altitudes(corners);
  const double lowest = *std::min_element(heights.begin(), heights.end());
  const double ratio = lowest / longest_edge(corners);
  quality.smallest_altitude = std::min(quality.smallest_altitude, lowest);
  if (ratio < quality.smallest_altitude_ratio) {
    quality.smallest_altitude_ratio = ratio;
    quality.worst_tet = tet;
  }
  for (const auto& [a, b] : edge_corners) sums.edges += (corners.col(a) - corners.col(b)).norm();
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

}  // namespace

// The faces that meet in the edge ab are those opposite to the two other corners c and d; between their
// outward normals lies π − dihedral. atan2 keeps its accuracy near 0 and 180 degrees.
std::array<double, 6> dihedral_angles(const Mat34<double>& corners) {
  std::array<double, 6> angles{};
  for (int e = 0; e < 6; ++e) {
    const auto& [c, d] = edge_corners[5 - e];  // the opposite edge
    const Vec3d n_c = face_normal(corners, c), n_d = face_normal(corners, d);
    angles[static_cast<std::size_t>(e)] =
        std::atan2(n_c.cross(n_d).norm(), -n_c.dot(n_d)) * 180 / std::numbers::pi;
  }
  return angles;
}

// V = area × altitude / 3
std::array<double, 4> altitudes(const Mat34<double>& corners) {
  const double six_volumes = 6 * std::abs(signed_volume(corners));
  std::array<double, 4> heights{};
  for (int k = 0; k < 4; ++k) {
    const double two_areas = face_normal(corners, k).norm();
    heights[static_cast<std::size_t>(k)] = two_areas > 0 ? six_volumes / two_areas : 0;
  }
  return heights;
}

Quality mesh_quality(const TetMesh& mesh) {
  Quality quality;
  const Box box = bounding_box(mesh);
  quality.box_min = box.min;
  quality.box_max = box.max;
  if (mesh.tet_count() == 0) return quality;
  quality.min_dihedral = 180;
  quality.smallest_tet_volume = quality.smallest_altitude = quality.smallest_altitude_ratio =
      std::numeric_limits<double>::infinity();
  Sums sums;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> corners = tet_points(mesh, t);
    const double volume = signed_volume(corners);
    quality.volume += volume;
    quality.smallest_tet_volume = std::min(quality.smallest_tet_volume, volume);
    add_angles(corners, quality, sums);
    add_lengths(corners, t, quality, sums);
  }
  quality.mean_edge = sums.edges / (6.0 * mesh.tet_count());
  quality.median_min_dihedral = median(sums.smallest_dihedrals);
  return quality;
}

}  // namespace lobe
