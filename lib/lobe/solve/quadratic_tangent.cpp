#include "lobe/solve/quadratic_tangent.h"

#include <algorithm>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/solve/tangent_factor.h"
#include "lobe/sort_unique.h"

namespace lobe {
namespace {

using Block30 = Eigen::Matrix<double, 30, 30>;

// ∂²W/∂u_j∂u_k / V at a point by the non-linear law, whose law_stiffness() takes four nodes: two pairs at a
// time.
Block30 nonlinear_point_stiffness(const Law<double>& law, const Mat3<double>& H, const NodeGradients& g) {
  Block30 K;
  for (int p = 0; p < 10; p += 2)
    for (int q = p + 2; q < 10; q += 2) {
      Mat34<double> four;
      four << g.middleCols<2>(p), g.middleCols<2>(q);
      const TetStiffness blocks = law_stiffness(law, H, four);
      K.block<6, 6>(3 * p, 3 * p) = blocks.topLeftCorner<6, 6>();
      K.block<6, 6>(3 * p, 3 * q) = blocks.topRightCorner<6, 6>();
      K.block<6, 6>(3 * q, 3 * p) = blocks.bottomLeftCorner<6, 6>();
      K.block<6, 6>(3 * q, 3 * q) = blocks.bottomRightCorner<6, 6>();
    }
  return K;
}

Block30 point_stiffness(const Law<double>& law, bool is_linear, const Mat3<double>& H,
                        const NodeGradients& g) {
  if (!is_linear) return nonlinear_point_stiffness(law, H, g);
  Block30 K;
  for (int j = 0; j < 10; ++j)
    for (int k = 0; k < 10; ++k) K.block<3, 3>(3 * j, 3 * k) = linear_block<double>(law, g.col(j), g.col(k));
  return K;
}

}  // namespace

QuadraticTangent::QuadraticTangent(const Elements& elements, const QuadraticMesh& mesh,
                                   const Unknowns& unknowns)
    : elements_(elements), mesh_(mesh), unknowns_(unknowns) {
  make_pattern();
}

// Components of a node are numbered one after another, and nodes in ascending order, so that the rows of a
// column are those of its own node and of the higher neighbours in turn.
void QuadraticTangent::make_pattern() {
  std::vector<std::vector<Index>> higher(std::size_t(mesh_.node_count()));
  for (Index t = 0; t < elements_.topology.tet_count(); ++t)
    for (Index a : mesh_.nodes.col(t))
      for (Index b : mesh_.nodes.col(t))
        if (b >= a) higher[std::size_t(a)].push_back(b);
  std::vector<int> lengths, rows;
  for (std::vector<Index>& list : higher) {
    sort_unique(list);
    std::vector<int> below;
    for (Index node : list)
      for (int axis = 0; axis < 3; ++axis)
        if (const Index row = unknowns_.number(axis, node); row >= 0) below.push_back(row);
    const Index own = static_cast<Index>(&list - higher.data());
    std::size_t first = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (unknowns_.number(axis, own) < 0) continue;
      rows.insert(rows.end(), below.begin() + std::ptrdiff_t(first), below.end());
      lengths.push_back(static_cast<int>(below.size() - first++));
    }
    std::vector<Index>().swap(list);
  }
  matrix_.resize(unknowns_.count, unknowns_.count);
  matrix_.resizeNonZeros(Eigen::Index(rows.size()));
  std::copy(rows.begin(), rows.end(), matrix_.innerIndexPtr());
  matrix_.outerIndexPtr()[0] = 0;
  for (std::size_t c = 0; c < lengths.size(); ++c)
    matrix_.outerIndexPtr()[c + 1] = matrix_.outerIndexPtr()[c] + lengths[c];
  std::fill_n(matrix_.valuePtr(), rows.size(), 0.0);
}

Law<double> QuadraticTangent::law_of(Index tet) const {
  if (is_linear(elements_.region_of[std::size_t(tet)])) return linear_law(elements_, tet);
  Law<double> law = nonlinear_law(elements_, tet);
  law.lambda = elements_.elastic_of(tet).lambda;
  return law;
}

QuadraticTangent::NodeColumns QuadraticTangent::nodes_of(Index tet, const Mat3X<double>& u) const {
  NodeColumns columns;
  for (int n = 0; n < 10; ++n) columns.col(n) = u.col(mesh_.nodes(n, tet));
  return columns;
}

EnergyAndForces QuadraticTangent::energy_and_forces(const Mat3X<double>& u) const {
  EnergyAndForces result;
  result.forces.setZero(3, u.cols());
  for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
    const Shape s = elements_.shape_of(t);
    const Law<double> law = law_of(t);
    const bool linear = is_linear(elements_.region_of[std::size_t(t)]);
    const NodeColumns at = nodes_of(t, u);
    NodeColumns f = NodeColumns::Zero();
    for (const Eigen::Vector4d& point : quadratic_points()) {
      const NodeGradients g = quadratic_gradients(s.gradients, point);
      const Mat3<double> H = at * g.transpose();
      result.energy += s.volume / 4 * (linear ? linear_energy_density(law, H) : law_energy_density(law, H));
      f -= s.volume / 4 * (linear ? linear_stress(law, H) : law_stress(law, H)) * g;
      const double ratio = linear ? 1 : 1 + volume_change(H);
      if (ratio >= result.smallest_volume_ratio) continue;
      result.smallest_volume_ratio = ratio;
      result.smallest_tet = t;
    }
    for (int n = 0; n < 10; ++n) result.forces.col(mesh_.nodes(n, t)) += f.col(n);
  }
  return result;
}

QuadraticTangent::Stiffness QuadraticTangent::stiffness_of(Index tet, const NodeColumns& u) const {
  const Shape s = elements_.shape_of(tet);
  const Law<double> law = law_of(tet);
  const bool linear = is_linear(elements_.region_of[std::size_t(tet)]);
  Stiffness K = Stiffness::Zero();
  for (const Eigen::Vector4d& point : quadratic_points()) {
    const NodeGradients g = quadratic_gradients(s.gradients, point);
    K += s.volume / 4 * point_stiffness(law, linear, u * g.transpose(), g);
  }
  return K;
}

Index QuadraticTangent::place_of(Index row, Index column) const {
  const int* rows = matrix_.innerIndexPtr();
  return static_cast<Index>(std::lower_bound(rows + matrix_.outerIndexPtr()[column],
                                             rows + matrix_.outerIndexPtr()[column + 1], row) -
                            rows);
}

void QuadraticTangent::update(const Mat3X<double>& u) {
  matrix_.coeffs().setZero();
  for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
    const Stiffness K = stiffness_of(t, nodes_of(t, u));
    const auto nodes = mesh_.nodes.col(t);
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 10; ++k) {
        if (nodes[j] < nodes[k]) continue;
        for (int b = 0; b < 3; ++b) {  // rows of one node follow each other
          const Index column = unknowns_.number(b, nodes[k]);
          if (column < 0) continue;
          Index place = -1;
          for (int a = j == k ? b : 0; a < 3; ++a) {
            const Index row = unknowns_.number(a, nodes[j]);
            if (row < 0) continue;
            if (place < 0) place = place_of(row, column);
            matrix_.valuePtr()[place++] += K(3 * j + a, 3 * k + b);
          }
        }
      }
  }
}

void QuadraticTangent::add_diagonal(const Mat3X<double>& k) {
  for (Eigen::Index i = 0; i < unknowns_.number.size(); ++i)
    if (const Index row = unknowns_.number.data()[i]; row >= 0)
      matrix_.valuePtr()[matrix_.outerIndexPtr()[row]] += k.data()[i];
}

std::unique_ptr<SparseFactor> QuadraticTangent::make_factor(const SparseFactorMaker& wanted) const {
  return make_tangent_factor(wanted, matrix_, false);
}

bool QuadraticTangent::factorise(SparseFactor& factor, bool& damped) {
  return factorise_damped(factor, matrix_, unknowns_.count, 0, damped);
}

Eigen::VectorXd QuadraticTangent::solve(const SparseFactor& factor, const Eigen::VectorXd& forces) const {
  return factor.solve(forces);
}

Eigen::VectorXd QuadraticTangent::solve(const SparseFactor& factor, const Eigen::VectorXd& forces,
                                        const Mat3X<double>& u, const Mat3X<double>& w) const {
  Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
  for (Index t = 0; t < elements_.topology.tet_count(); ++t) {
    const NodeColumns by = nodes_of(t, w);
    if (by.isZero(0)) continue;
    const Eigen::Matrix<double, 30, 1> force = stiffness_of(t, nodes_of(t, u)) * by.reshaped();
    for (int n = 0; n < 10; ++n) f.col(mesh_.nodes(n, t)) += force.segment<3>(3 * n);
  }
  return factor.solve(forces - unknowns_.gather(f));
}

}  // namespace lobe
