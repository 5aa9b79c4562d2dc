#include "lobe/diagnostics/locate.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <numeric>

#include "lobe/cut/distance.h"
#include "lobe/error.h"

namespace lobe {
namespace {

constexpr Index leaf_size = 4;

Eigen::AlignedBox3d box_of(const TetMesh& mesh, Index tet) {
  const Mat34<double> corners = tet_points(mesh, tet);
  return {corners.rowwise().minCoeff(), corners.rowwise().maxCoeff()};
}

}  // namespace

Locator::Locator(const TetMesh& mesh) : mesh_(mesh), tets_(std::size_t(mesh.tet_count())) {
  if (mesh.tet_count() == 0) throw InputError("mesh", "has no tetrahedron in which a point could lie");
  std::iota(tets_.begin(), tets_.end(), 0);
  Mat3X<double> centres(3, mesh.tet_count());
  for (Index t = 0; t < mesh.tet_count(); ++t) centres.col(t) = barycentre(mesh, t);
  nodes_.push_back({{}, 0, mesh.tet_count(), -1});
  for (std::size_t node = 0; node < nodes_.size(); ++node) split(Index(node), centres);
}

// Halves the tetrahedra of a node by their barycentres along its box's longest side.
void Locator::split(Index node, const Mat3X<double>& centres) {
  Node& parent = nodes_[node];
  const Index begin = parent.begin, end = parent.end, middle = begin + (end - begin) / 2;
  for (Index i = begin; i < end; ++i) parent.box.extend(box_of(mesh_, tets_[i]));
  if (end - begin <= leaf_size) return;
  Eigen::Index axis = 0;
  parent.box.sizes().maxCoeff(&axis);
  std::nth_element(tets_.begin() + begin, tets_.begin() + middle, tets_.begin() + end,
                   [&](Index s, Index t) { return centres(axis, s) < centres(axis, t); });
  parent.left = Index(nodes_.size());
  nodes_.push_back({{}, begin, middle, -1});
  nodes_.push_back({{}, middle, end, -1});
}

Locator::Found Locator::nearest(const Vec3d& p, Index guess) const {
  Found best{-1, std::numeric_limits<double>::infinity()};
  const auto consider = [&](Index tet) {
    const double distance = distance_to_tet(p, tet_points(mesh_, tet));
    if (distance < best.distance) best = {tet, distance};
  };
  if (guess >= 0) consider(guess);
  Index stack[128], height = 0;  // halving leaves at most 32 levels of two
  stack[height++] = 0;
  while (height > 0 && best.distance > 0) {
    const Node& node = nodes_[stack[--height]];
    if (node.box.exteriorDistance(p) >= best.distance) continue;
    if (node.left < 0) {
      for (Index i = node.begin; i < node.end; ++i) consider(tets_[i]);
      continue;
    }
    const double left = nodes_[node.left].box.squaredExteriorDistance(p);
    const double right = nodes_[node.left + 1].box.squaredExteriorDistance(p);
    stack[height++] = left < right ? node.left + 1 : node.left;  // the nearer one is taken first
    stack[height++] = left < right ? node.left : node.left + 1;
  }
  return best;
}

Eigen::Vector4d barycentric(const TetMesh& mesh, Index tet, const Vec3d& p) {
  return barycentric(tet_points(mesh, tet), p);
}

Eigen::Vector4d barycentric(const Mat34<double>& X, const Vec3d& p) {
  const Mat3<double> D = X.rightCols<3>().colwise() - X.col(0);
  Eigen::Vector4d coordinates;
  coordinates.tail<3>() = D.inverse() * (p - X.col(0));
  coordinates[0] = 1 - coordinates.tail<3>().sum();
  return coordinates;
}

}  // namespace lobe
