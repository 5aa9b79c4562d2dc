#include "lobe/haptic/contact_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

constexpr Index none = -1, in_contact = -2;

}  // namespace

// Ring by ring, so that the nearest come first; in each ring by number, so that the order is the same
// whatever came before.
void ContactPatch::choose_vertices(const Model& model, std::span<const Index> contact,
                                   const ContactPatchLimits& limits) {
  const Topology& topology = model.elements.topology;
  const auto X = model.elements.points.view();
  for (Index v : vertices_)
    if (v < static_cast<Index>(place_.size())) place_[std::size_t(v)] = none;
  place_.resize(std::size_t(topology.vertex_count()), none);
  vertices_.clear();
  free_ = 0;
  Vec3d centre = Vec3d::Zero();
  for (Index v : contact) {
    place_[std::size_t(v)] = in_contact;
    vertices_.push_back(v);
    centre += X.col(v) / double(contact.size());
  }
  double radius = 0;
  for (Index v : contact) radius = std::max(radius, (X.col(v) - centre).norm());
  for (std::size_t begin = 0; begin < vertices_.size();) {
    const std::size_t end = vertices_.size();
    for (std::size_t i = begin; i < end; ++i)
      for (Index t : topology.around(vertices_[i]))
        for (Index v : topology.corners(t)) {
          if (place_[std::size_t(v)] != none || model.held.fixes(v)) continue;
          if ((X.col(v) - centre).norm() > radius + limits.reach) continue;
          if (free_ == limits.most_free) continue;
          place_[std::size_t(v)] = free_++;
          vertices_.push_back(v);
        }
    begin = end;
  }
}

void ContactPatch::gather(const Model& model, std::span<const Index> contact,
                          const std::function<Vec3d(Index)>& displacement, const ContactPatchLimits& limits) {
  choose_vertices(model, contact, limits);
  const Index size = 3 * free_ + 3;
  K_.resize(size, size);
  K_.setZero();
  tets_.clear();
  for (Index v : vertices_) {
    const auto around = model.elements.topology.around(v);
    tets_.insert(tets_.end(), around.begin(), around.end());
  }
  std::sort(tets_.begin(), tets_.end());
  tets_.erase(std::unique(tets_.begin(), tets_.end()), tets_.end());
  corners_.clear();
  for (Index t : tets_) {
    corners_.push_back(model.elements.topology.corners(t));
    add_tet(model, t, displacement);
  }
}

bool ContactPatch::is_cut(const Topology& topology) const {
  for (std::size_t i = 0; i < tets_.size(); ++i)
    if (!topology.alive(tets_[i]) || topology.corners(tets_[i]) != corners_[i]) return true;
  return false;
}

void ContactPatch::add_tet(const Model& model, Index tet, const std::function<Vec3d(Index)>& displacement) {
  const Eigen::Vector4i corners = model.elements.topology.corners(tet);
  Mat34<double> u;
  Index at[4];
  for (int c = 0; c < 4; ++c) {
    u.col(c) = displacement(corners[c]);
    const Index place = place_[std::size_t(corners[c])];
    at[c] = place == none ? none : 3 * (place == in_contact ? free_ : place);
  }
  const TetStiffness K = tet_stiffness(model.elements, tet, u);
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b)
      if (at[a] != none && at[b] != none && at[a] >= at[b])
        K_.block<3, 3>(at[a], at[b]) += K.block<3, 3>(3 * a, 3 * b);
}

Mat3<double> ContactPatch::blocked() const {
  const Mat3<double> K = K_.bottomRightCorner<3, 3>();
  return 0.5 * (K + K.transpose());
}

Mat3<double> ContactPatch::condense() {
  const Mat3<double> K_rr = blocked();
  const Index n = 3 * free_;
  if (n == 0) return K_rr;
  Eigen::Ref<Eigen::MatrixXd> K_ff(K_.topLeftCorner(n, n));
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(K_ff);
  if (factor.info() != Eigen::Success) return K_rr;  // crushed: the bound is all that is known
  Eigen::Matrix<double, Eigen::Dynamic, 3> half = K_.bottomLeftCorner(3, n).transpose();
  factor.matrixL().solveInPlace(half);
  return K_rr - half.transpose() * half;
}

Mat3<double> clamped(const Mat3<double>& K, double highest) {
  const auto [values, Q] = symmetric_eigen<Mat3<double>>(0.5 * (K + K.transpose()));
  const Vec3d within = values.cwiseMax(0.0).cwiseMin(highest);
  return Q * within.asDiagonal() * Q.transpose();
}

Mat3<double> clamped_to(const Mat3<double>& K, const Mat3<double>& A, double least, double most) {
  const auto [squares, Q] = symmetric_eigen<Mat3<double>>(0.5 * (A + A.transpose()));
  const Vec3d root = squares.cwiseMax(0.0).cwiseSqrt();
  const double smallest = 1e-6 * root.maxCoeff();  // of a direction without stiffness K has none
  const Vec3d inverse = root.unaryExpr([&](double r) { return r > smallest ? 1 / r : 0.0; });
  const Mat3<double> to = inverse.asDiagonal() * Q.transpose(), from = Q * root.asDiagonal();
  const auto [ratios, R] = symmetric_eigen<Mat3<double>>(0.5 * to * (K + K.transpose()) * to.transpose());
  const Vec3d values = ratios.cwiseMax(least).cwiseMin(most);
  return from * R * values.asDiagonal() * R.transpose() * from.transpose();
}

double highest_eigenvalue(const Mat3<double>& K) { return symmetric_eigenvalues(K)[2]; }

double shear_speed(const Elements& elements, Index tet) {
  const Elastic& elastic = elements.elastic_of(tet);
  return std::sqrt(elastic.mu / elastic.density);
}

}  // namespace lobe
