#include "lobe/linearity/two_grid.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "lobe/fem/hooke.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/supernodal_factor.h"
#include "lobe/numerics/symmetric_eigen.h"

namespace lobe {
namespace {

// D⁻¹ K has no eigenvalue above 4, the number of corners of a tetrahedron.
constexpr double relaxation = 0.5;
constexpr double spring_stiffness = 4;  // softer ones would let the lattice correct too much

using Entries = std::vector<Eigen::Triplet<double>>;

// The factor of a matrix that is near the one to be solved with, as a preconditioner for Eigen.
struct NearFactor {
  const SparseFactor* factor = nullptr;
  NearFactor& compute(const auto&) { return *this; }  // Eigen's view of the matrix, which is not copied
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const { return factor->solve(b); }
  Eigen::ComputationInfo info() const { return Eigen::Success; }
};

Elements all_reduced(Elements elements) {
  std::fill(elements.region_of.begin(), elements.region_of.end(), RegionModel::reduced);
  return elements;
}

// Of any edge, around the middle of a body.
LatticeFrame frame_around(const Elements& elements, double edge) {
  const Vec3d low = elements.points.view().rowwise().minCoeff(),
              high = elements.points.view().rowwise().maxCoeff();
  const Vec3d cells = ((high - low) / edge).array().ceil();
  return {edge, (low + high) / 2 - edge / 2 * cells};
}

// Symmetric, block by block; each row has few columns.
class Blocks {
 public:
  explicit Blocks(Index rows) : rows_(std::size_t(rows)) {}
  Mat3<double>& at(Index row, Index column) {
    auto& own = rows_[std::size_t(row)];
    for (auto& [there, block] : own)
      if (there == column) return block;
    return own.emplace_back(column, Mat3<double>::Zero()).second;
  }
  SparseFactor::Matrix lower_triangle() const {
    Entries entries;
    for (std::size_t row = 0; row < rows_.size(); ++row)
      for (const auto& [column, block] : rows_[row])
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            if (const Index at = 3 * static_cast<Index>(row) + i, beside = 3 * column + j; at >= beside)
              entries.emplace_back(at, beside, block(i, j));
    const auto size = 3 * static_cast<Index>(rows_.size());
    SparseFactor::Matrix matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

 private:
  std::vector<std::vector<std::pair<Index, Mat3<double>>>> rows_;
};

}  // namespace

TwoGrid::TwoGrid(const Elements& of_body, double edge) {
  const Elements elements = all_reduced(of_body);
  lattice_ = make_lattice(elements, frame_around(elements, edge));
  find_masses(elements);
  find_diagonal(elements);
  find_stiffness(elements);
}

void TwoGrid::find_masses(const Elements& elements) {
  const auto vertices = std::size_t(elements.topology.vertex_count());
  weights_.assign(vertices, CellWeights::Zero());
  mass_.assign(vertices, 0);
  node_mass_.assign(std::size_t(lattice_.node_count()), 0);
  for (Index v = 0; v < vertex_count(); ++v) {
    if (!moves(v)) continue;
    const CellWeights w = weights_[std::size_t(v)] = lattice_.weights(v, elements.points.col(v));
    mass_[std::size_t(v)] = lumped_mass(elements, v);
    for (int n = 0; n < 8; ++n)
      node_mass_[std::size_t(nodes_of(v)[std::size_t(n)])] += w[n] * mass_[std::size_t(v)];
  }
}

void TwoGrid::find_diagonal(const Elements& elements) {
  diagonal_.assign(mass_.size(), Mat3<double>::Zero());
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Shape shape = elements.shape_of(t);
    const Law<double> law = nonlinear_law(elements, t);
    const Eigen::Vector4i corners = elements.topology.corners(t);
    for (int c = 0; c < 4; ++c)
      diagonal_[std::size_t(corners[c])] +=
          shape.volume * law_diagonal_block<double>(law, Mat3<double>::Zero(), shape.gradients.col(c));
  }
}

// Bᵀ K B, where vertices have the values B q of the nodes. In a tetrahedron, the function of a node has the
// gradient Σ_c w(X_c) α_c.
void TwoGrid::find_stiffness(const Elements& elements) {
  Blocks blocks(lattice_.node_count());
  std::vector<std::pair<Index, Vec3d>> gradients;  // of the nodes that move a tetrahedron
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Shape shape = elements.shape_of(t);
    const Law<double> law = nonlinear_law(elements, t);
    gradients.clear();
    for (int c = 0; c < 4; ++c) {
      const Index v = elements.topology.corners(t)[c];
      for (std::size_t n = 0; n < 8; ++n) {
        const Vec3d own = weights_[std::size_t(v)][Eigen::Index(n)] * shape.gradients.col(c);
        const auto is_it = [&](const auto& other) { return other.first == nodes_of(v)[n]; };
        const auto there = std::find_if(gradients.begin(), gradients.end(), is_it);
        if (there == gradients.end())
          gradients.emplace_back(nodes_of(v)[n], own);
        else
          there->second += own;
      }
    }
    // The volume term has no stiffness at rest. It has that of κ where a volume has changed by half.
    const double lambda = law.lambda + (law.terms.volume ? law.kappa : 0);
    for (const auto& [n, of_n] : gradients)
      for (const auto& [m, of_m] : gradients)
        if (n >= m) blocks.at(n, m) += shape.volume * hooke_block<double>(of_n, of_m, lambda, law.mu);
  }
  stiffness_ = blocks.lower_triangle();
  if (lattice_.node_count() == 0) return;
  factor_ = make_supernodal();
  factor_->analyse(stiffness_);
}

void TwoGrid::add_spring(const HeldVertices::Held& item, SparseFactor::Matrix& A) {
  const CellWeights& w = weights_[std::size_t(item.vertex)];
  const auto& nodes = nodes_of(item.vertex);
  const double spring = spring_stiffness * s_ * largest_eigenvalue(diagonal_[std::size_t(item.vertex)]);
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t n = 0; n < 8; ++n)
      for (std::size_t m = 0; item.axes[axis] && m < 8; ++m)
        if (nodes[n] >= nodes[m])
          A.coeffRef(3 * nodes[n] + axis, 3 * nodes[m] + axis) +=
              spring * w[Eigen::Index(n)] * w[Eigen::Index(m)];
}

void TwoGrid::prepare(const HeldVertices& held, double s, double w) {
  s_ = s;
  w_ = w;
  relaxation_.clear();
  for (std::size_t v = 0; v < mass_.size(); ++v) {
    const Mat3<double> own = s_ * diagonal_[v] + w_ * mass_[v] * Mat3<double>::Identity();
    relaxation_.push_back(mass_[v] > 0 ? Mat3<double>(relaxation * own.inverse()) : Mat3<double>::Zero());
  }
  matrix_ = s_ * stiffness_;
  for (Index i = 0; i < 3 * lattice_.node_count(); ++i)
    matrix_.coeffRef(i, i) += w_ * node_mass_[std::size_t(i / 3)];
  is_held_.setConstant(3, Eigen::Index(mass_.size()), false);
  for (Index v = 0; v < vertex_count(); ++v)
    if (!moves(v)) is_held_.col(v).setConstant(true);
  const auto hold = [&](bool by_tools) {
    bool any = false;
    for (const HeldVertices::Held& item : held.all()) {
      if (!moves(item.vertex) || (item.holder != HeldVertices::boundary) != by_tools) continue;
      for (int axis = 0; axis < 3; ++axis)
        if (item.axes[axis]) is_held_(axis, item.vertex) = true;
      add_spring(item, matrix_);
      any = true;
    }
    return any;
  };
  hold(false);
  const bool is_first = factored_ == Factor::none;
  if (is_first) factored_ = factor_ && factor_->factorise(matrix_) ? Factor::exact : Factor::failed;
  const bool tools_hold = hold(true);
  if (factored_ != Factor::failed) factored_ = is_first && !tools_hold ? Factor::exact : Factor::near;
}

// The right hand side is itself no more than a part of a cycle: a tenth of the residual is enough.
Eigen::VectorXd TwoGrid::solve_lattice(const Eigen::VectorXd& f) const {
  if (factored_ == Factor::exact) return factor_->solve(f);
  Eigen::ConjugateGradient<SparseFactor::Matrix, Eigen::Lower, NearFactor> gradients;
  gradients.preconditioner().factor = factor_.get();
  gradients.setTolerance(0.1);
  gradients.setMaxIterations(30);
  return gradients.compute(matrix_).solve(f);
}

void TwoGrid::clear_held(Mat3X<double>& x) const {
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (is_held_.data()[i]) x.data()[i] = 0;
}

Mat3X<double> TwoGrid::left(const Product& product, const Mat3X<double>& f, const Mat3X<double>& x) const {
  Mat3X<double> left = product(x);
  for (Index v = 0; v < vertex_count(); ++v)
    left.col(v) = f.col(v) - s_ * left.col(v) - w_ * mass_[std::size_t(v)] * x.col(v);
  return left;
}

Mat3X<double> TwoGrid::relaxed(Mat3X<double> f) const {
  clear_held(f);
  for (Index v = 0; v < vertex_count(); ++v) {
    const Vec3d own = f.col(v);
    f.col(v) = relaxation_[std::size_t(v)] * own;
  }
  clear_held(f);
  return f;
}

Mat3X<double> TwoGrid::of_lattice(Mat3X<double> f) const {
  if (factored_ == Factor::none || factored_ == Factor::failed) return Mat3X<double>::Zero(3, f.cols());
  clear_held(f);
  Eigen::VectorXd of_nodes = Eigen::VectorXd::Zero(3 * lattice_.node_count());
  for (Index v = 0; v < vertex_count(); ++v)
    for (std::size_t n = 0; moves(v) && n < 8; ++n)
      of_nodes.segment<3>(3 * nodes_of(v)[n]) += weights_[std::size_t(v)][Eigen::Index(n)] * f.col(v);
  of_nodes = solve_lattice(of_nodes);
  f.setZero();
  for (Index v = 0; v < vertex_count(); ++v)
    for (std::size_t n = 0; moves(v) && n < 8; ++n)
      f.col(v) += weights_[std::size_t(v)][Eigen::Index(n)] * of_nodes.segment<3>(3 * nodes_of(v)[n]);
  clear_held(f);
  return f;
}

Mat3X<double> TwoGrid::solve(const Product& product, const Mat3X<double>& f) const {
  Mat3X<double> x = relaxed(f);
  x += of_lattice(left(product, f, x));
  x += relaxed(left(product, f, x));
  return x;
}

}  // namespace lobe
