#include "lobe/haptic/contact_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/solve/tangent.h"
#include "lobe/sort_unique.h"

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
  sort_unique(tets_);
  for (Index t : tets_) add_tet(model, t, displacement);
  if (any_smoothed(model.elements.materials)) add_domains(model, displacement);
  corners_.clear();
  for (Index t : tets_) corners_.push_back(model.elements.topology.corners(t));
}

bool ContactPatch::is_cut(const Topology& topology) const {
  for (std::size_t i = 0; i < tets_.size(); ++i)
    if (!topology.alive(tets_[i]) || topology.corners(tets_[i]) != corners_[i]) return true;
  return false;
}

Index ContactPatch::row_of(Index vertex) const {
  const Index place = place_[std::size_t(vertex)];
  return place == none ? none : 3 * (place == in_contact ? free_ : place);
}

// All that a plain tetrahedron has; of a smoothed one what its domains leave: volume term and guard.
void ContactPatch::add_tet(const Model& model, Index tet, const std::function<Vec3d(Index)>& displacement) {
  const Eigen::Vector4i corners = model.elements.topology.corners(tet);
  Mat34<double> u;
  Index at[4];
  for (int c = 0; c < 4; ++c) {
    u.col(c) = displacement(corners[c]);
    at[c] = row_of(corners[c]);
  }
  const TetStiffness K = unsmoothed_stiffness(model.elements, tet, u, model.elements.region_of[tet]);
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b)
      if (at[a] != none && at[b] != none && at[a] >= at[b])
        K_.block<3, 3>(at[a], at[b]) += K.block<3, 3>(3 * a, 3 * b);
}

void ContactPatch::find_domains(const Elements& elements) {
  domains_.clear();
  for (Index t : tets_) {
    if (!elements.elastic_of(t).is_smoothed()) continue;
    const Eigen::Vector4i corners = elements.topology.corners(t);
    for (const auto& ends : edge_corners) {
      const auto [a, b] = std::minmax(corners[ends[0]], corners[ends[1]]);
      domains_.push_back({a, b, elements.material_of[std::size_t(t)], elements.region_of[std::size_t(t)]});
    }
  }
  sort_unique(domains_);
}

// The domains of all edges of the tetrahedra that were gathered. Some reach a tetrahedron further: a cut of
// that changes them, too.
void ContactPatch::add_domains(const Model& model, const std::function<Vec3d(Index)>& displacement) {
  const Elements& elements = model.elements;
  find_domains(elements);
  for (const Domain& domain : domains_) {
    around_.clear();
    for (Index t : elements.topology.around(domain.a))
      if (elements.material_of[std::size_t(t)] == domain.material &&
          elements.region_of[std::size_t(t)] == domain.model &&
          (elements.topology.corners(t).array() == domain.b).any())
        around_.push_back(t);
    find_smoothed_edge(elements, domain.a, domain.b, around_, edge_);
    add_domain(elements, displacement);
    tets_.insert(tets_.end(), around_.begin(), around_.end());
  }
  sort_unique(tets_);
}

// V_e b_j·C b_k of the vertices of edge_, as domain_stiffness() has them, without allocating.
void ContactPatch::add_domain(const Elements& elements, const std::function<Vec3d(Index)>& displacement) {
  const auto count = edge_.vertices.size();
  Mat3<double> H = Mat3<double>::Zero();
  const Vec3d first = displacement(edge_.vertices[0]);
  for (std::size_t j = 1; j < count; ++j)
    H += (displacement(edge_.vertices[j]) - first) * edge_.gradients[j].transpose();
  const Moduli C = edge_.volume * domain_moduli(elements, edge_, H, edge_.model);
  for (std::size_t k = 0; k < count; ++k) {
    const Index column = row_of(edge_.vertices[k]);
    if (column == none) continue;
    const Vec3d& b = edge_.gradients[k];
    const Eigen::Matrix<double, 9, 3> Cb =
        b[0] * C.leftCols<3>() + b[1] * C.middleCols<3>(3) + b[2] * C.rightCols<3>();
    for (std::size_t j = 0; j < count; ++j) {
      const Index row = row_of(edge_.vertices[j]);
      if (row < column) continue;
      const Vec3d& a = edge_.gradients[j];
      K_.block<3, 3>(row, column) +=
          a[0] * Cb.topRows<3>() + a[1] * Cb.middleRows<3>(3) + a[2] * Cb.bottomRows<3>();
    }
  }
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
  const Elastic elastic = elements.elastic_of(tet).at_once();
  return std::sqrt(elastic.mu / elastic.density);
}

}  // namespace lobe
