// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/volumes.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "lobe_mesh/diagnose.h"

namespace lobe::meshing {
namespace {

constexpr double aim = 0.95;                // of the accepted error
constexpr double farthest = 0.25;           // edges from the surface
constexpr double smallest_remaining = 0.3;  // volume of a tetrahedron after a move, of that before
constexpr int most_passes = 20;

class VolumeMatch {
 public:
  VolumeMatch(TetMesh& mesh, const Interfaces& interfaces, const Freedom& freedom,
              const std::vector<double>& goals);
  void run();

 private:
  using Gradient = std::pair<int, Vec3d>;  // ∂V/∂x_v of a label

  void weigh(const Interfaces& interfaces);
  void find_gradients();
  Eigen::VectorXd pressures() const;
  void move(Index v, const Vec3d& shift);
  bool keeps_shape(Index v, const Vec3d& x) const;
  double distance(Index v, const Vec3d& x) const { return (freedom_.on_surfaces(v, x) - x).norm(); }

  TetMesh& mesh_;
  const Freedom& freedom_;
  const std::vector<double>& goals_;
  std::vector<InterfaceFace> faces_;
  std::vector<Index> vertices_;  // that may move
  std::vector<std::vector<Index>> tets_at_;
  std::vector<double> weight_, reach_;
  std::vector<std::vector<Gradient>> gradients_;
};

VolumeMatch::VolumeMatch(TetMesh& mesh, const Interfaces& interfaces, const Freedom& freedom,
                         const std::vector<double>& goals)
    : mesh_(mesh), freedom_(freedom), goals_(goals), faces_(interface_faces(mesh)) {
  weigh(interfaces);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (weight_[v] > 0) vertices_.push_back(v);
  tets_at_.resize(mesh.vertex_count());
  for (Index t = 0; t < mesh.tet_count(); ++t)
    for (const Index v : mesh.tets.col(t))
      if (weight_[v] > 0) tets_at_[v].push_back(t);
}

// The height of the surface over the chords of a triangle: the distance from the surface at its centre, less
// the distance of its corners, which may have been moved off the surface before.
void VolumeMatch::weigh(const Interfaces& interfaces) {
  std::vector<double> area_at(mesh_.vertex_count(), 0), faces_at(mesh_.vertex_count(), 0);
  weight_.assign(mesh_.vertex_count(), 0);
  reach_.assign(mesh_.vertex_count(), 0);
  for (const InterfaceFace& face : faces_) {
    const auto found = interfaces.find(std::minmax(face.label, face.other));
    if (found == interfaces.end()) continue;
    const NearestPoint& surface = *found->second;
    Mat3<double> x;
    for (int k = 0; k < 3; ++k) x.col(k) = mesh_.points.col(face.corners[k]);
    const Vec3d twice_area = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)),
                normal = twice_area.normalized(), centre = x.rowwise().mean();
    double height = normal.dot(surface(centre) - centre);
    for (int k = 0; k < 3; ++k) height -= normal.dot(surface(x.col(k)) - x.col(k)) / 3;
    for (const Index v : face.corners) {
      weight_[v] += twice_area.norm() / 2 * std::abs(height);
      area_at[v] += twice_area.norm() / 2;
      faces_at[v] += 1;
    }
  }
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (area_at[v] == 0) continue;
    const double height = weight_[v] / area_at[v], edge = std::sqrt(2.3 * area_at[v] / faces_at[v]);
    reach_[v] = farthest * edge;
    const bool moves = !freedom_.is_fixed[v] && height > 1e-9 * edge;
    weight_[v] = moves ? height / area_at[v] : 0;
  }
}

// V of a closed surface is Σ a · (b × c) / 6 over its triangles.
void VolumeMatch::find_gradients() {
  gradients_.assign(mesh_.vertex_count(), {});
  const auto add = [&](Index v, int label, const Vec3d& g) {
    if (label < 0 || weight_[v] == 0) return;
    auto& all = gradients_[v];
    const auto known =
        std::find_if(all.begin(), all.end(), [&](const Gradient& one) { return one.first == label; });
    if (known == all.end())
      all.emplace_back(label, g);
    else
      known->second += g;
  };
  for (const InterfaceFace& face : faces_) {
    for (int k = 0; k < 3; ++k) {
      const Vec3d b = mesh_.points.col(face.corners[(k + 1) % 3]),
                  c = mesh_.points.col(face.corners[(k + 2) % 3]);
      const Vec3d g = b.cross(c) / 6;
      add(face.corners[k], face.label, g);
      add(face.corners[k], face.other, -g);
    }
  }
}

// Finds p of the labels whose error is above the accepted one, so that the error falls below it. p is 0 for
// the other labels; their volumes may change. The rank is below the number of labels if no vertex of a label
// can move.
Eigen::VectorXd VolumeMatch::pressures() const {
  const auto labels = static_cast<Eigen::Index>(goals_.size());
  const std::vector<double> volumes = label_volumes(mesh_, static_cast<int>(labels));
  Eigen::VectorXd missing = Eigen::VectorXd::Zero(labels);
  std::vector<Eigen::Index> wrong;
  for (Eigen::Index k = 0; k < labels; ++k) {
    const double error = volumes[k] / goals_[k] - 1,
                 wanted = std::copysign(aim * accepted_volume_error, error);
    if (volumes[k] == 0 || std::abs(error) <= std::abs(wanted)) continue;
    missing[k] = (wanted - error) * goals_[k];
    wrong.push_back(k);
  }
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(labels, labels);
  for (const Index v : vertices_)
    for (const auto& [i, g] : gradients_[v])
      for (const auto& [j, h] : gradients_[v]) A(i, j) += weight_[v] * g.dot(h);
  const Eigen::VectorXd found = A(wrong, wrong).completeOrthogonalDecomposition().solve(missing(wrong));
  Eigen::VectorXd p = Eigen::VectorXd::Zero(labels);
  p(wrong) = found;
  return p;
}

bool VolumeMatch::keeps_shape(Index v, const Vec3d& x) const {
  return std::all_of(tets_at_[v].begin(), tets_at_[v].end(), [&](Index t) {
    Mat34<double> corners = tet_points(mesh_, t);
    const double before = signed_volume(corners);
    for (int k = 0; k < 4; ++k)
      if (mesh_.tets(k, t) == v) corners.col(k) = x;
    return signed_volume(corners) > smallest_remaining * before;
  });
}

void VolumeMatch::move(Index v, const Vec3d& shift) {
  const Vec3d old = mesh_.points.col(v);
  const double limit = std::max(reach_[v], distance(v, old)),
               longest = std::min(1.0, reach_[v] / shift.norm());
  for (const double part : {1.0, 0.5, 0.25}) {
    const Vec3d x = old + part * longest * shift;
    if (distance(v, x) > limit || !keeps_shape(v, x)) continue;
    mesh_.points.col(v) = x;
    return;
  }
}

void VolumeMatch::run() {
  double last = largest_volume_error(mesh_, goals_);
  for (int round = 0; round < most_passes && last > accepted_volume_error; ++round) {
    find_gradients();
    const Eigen::VectorXd p = pressures();
    const Mat3X<double> before = mesh_.points;
    for (const Index v : vertices_) {
      Vec3d shift = Vec3d::Zero();
      for (const auto& [k, g] : gradients_[v]) shift += weight_[v] * p[k] * g;
      move(v, shift);
    }
    const double now = largest_volume_error(mesh_, goals_);
    if (now > last) mesh_.points = before;
    if (now > 0.98 * last) return;
    last = now;
  }
}

}  // namespace

std::vector<double> label_volumes(const TetMesh& mesh, int count) {
  std::vector<double> volumes(count, 0);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    volumes[mesh.labels.empty() ? 0 : mesh.labels[t]] += signed_volume(tet_points(mesh, t));
  return volumes;
}

double largest_volume_error(const TetMesh& mesh, const std::vector<double>& goals) {
  const std::vector<double> volumes = label_volumes(mesh, static_cast<int>(goals.size()));
  double largest = 0;
  for (std::size_t k = 0; k < goals.size(); ++k)
    if (volumes[k] > 0) largest = std::max(largest, std::abs(volumes[k] / goals[k] - 1));
  return largest;
}

void match_volumes(TetMesh& mesh, const Interfaces& interfaces, const Freedom& freedom,
                   const std::vector<double>& goals) {
  if (largest_volume_error(mesh, goals) <= accepted_volume_error) return;
  TetMesh matched = mesh;
  VolumeMatch(matched, interfaces, freedom, goals).run();
  const auto intersections = [](const TetMesh& m) {
    return diagnose(boundary_surface(m)).self_intersections.count;
  };
  const Index after = intersections(matched);
  if (after == 0 || after <= intersections(mesh)) mesh.points = std::move(matched.points);
}

}  // namespace lobe::meshing
