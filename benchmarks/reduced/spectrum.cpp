#include "benchmarks/reduced/spectrum.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

namespace lobe::reduced {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;
struct Share {
  Index unknown;  // -1: held
  double weight;
};

struct System {
  Eigen::SparseMatrix<double> K;
  Eigen::VectorXd M;
};

// `number`: of the unknown of each node, -1 where no cell and no vertex needs it.
std::vector<std::vector<Share>> shares_of(const Lattice& lattice, const Membership& membership,
                                          std::vector<Index>& number, Index& count) {
  number.assign(lattice.node_count, -1);
  std::vector<std::vector<Share>> shares(membership.motion.size());
  count = 0;
  for (std::size_t v = 0; v < shares.size(); ++v) {
    if (membership.motion[v] == Motion::own) shares[v].push_back({count++, 1});
    if (membership.motion[v] != Motion::embedded) continue;
    const Index cell = lattice.cell_of_vertex[v];
    for (int n = 0; n < 8; ++n) {
      Index& own = number[lattice.nodes[cell][n]];
      if (own < 0) own = count++;
      shares[v].push_back({own, lattice.weights[v][n]});
    }
  }
  for (std::size_t c = 0; c < membership.embedded.size(); ++c)
    for (int n = 0; n < 8 && !membership.embedded[c].empty(); ++n)
      if (Index& own = number[lattice.nodes[c][n]]; own < 0) own = count++;
  return shares;
}

void add_tet(const Elements& elements, Index t, const std::vector<std::vector<Share>>& shares,
             Triplets& entries) {
  const Shape shape = elements.shape_of(t);
  const Elastic& e = elements.elastic_of(t);
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      const Vec3d g = shape.gradients.col(a), k = shape.gradients.col(b);
      const Mat3<double> K = shape.volume * (e.lambda * g * k.transpose() + e.mu * k * g.transpose() +
                                             e.mu * g.dot(k) * Mat3<double>::Identity());
      for (const Share& p : shares[elements.topology.tets()(a, t)])
        for (const Share& q : shares[elements.topology.tets()(b, t)])
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
              entries.emplace_back(3 * p.unknown + i, 3 * q.unknown + j, p.weight * q.weight * K(i, j));
    }
}

void add_cell(const Lattice& lattice, const Cell& cell, Index number, const std::vector<Index>& unknowns,
              const Elastic& e, Triplets& entries) {
  Eigen::Matrix<double, 3, 8> mean = Eigen::Matrix<double, 3, 8>::Zero();  // ∂H/∂q of each node
  for (int n = 0; n < 8; ++n) {
    for (int d = 0; d < 3; ++d) mean(d, n) = sign(1 + d, n) / 8 * 2 / lattice.spacing;
    for (int k = 0; k < 4; ++k) mean.col(n) += sign(4 + k, n) / 8 * cell.mean.col(k);
  }
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b) {
      const Vec3d g = mean.col(a), h = mean.col(b);
      Mat3<double> K = cell.volume * (e.lambda * g * h.transpose() + e.mu * h * g.transpose() +
                                      e.mu * g.dot(h) * Mat3<double>::Identity());
      for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l)
          K += sign(4 + k, a) * sign(4 + l, b) / 64 * cell.K.block<3, 3>(3 * k, 3 * l);
      const Index p = unknowns[lattice.nodes[number][a]], q = unknowns[lattice.nodes[number][b]];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) entries.emplace_back(3 * p + i, 3 * q + j, K(i, j));
    }
}

System assemble(const Elements& elements, const Lattice& lattice, const Membership& membership,
                Stiffening stiffening) {
  Index count = 0;
  std::vector<Index> unknowns;
  const auto shares = shares_of(lattice, membership, unknowns, count);
  System system;
  system.M = Eigen::VectorXd::Zero(3 * count);
  for (std::size_t v = 0; v < shares.size(); ++v) {
    const double mass = lumped_mass(elements, static_cast<Index>(v));
    for (const Share& share : shares[v])
      system.M.segment<3>(3 * share.unknown).array() += mass * share.weight;
  }
  const double least = 1e-6 * system.M.mean();
  system.M = system.M.cwiseMax(least);
  Triplets entries;
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (membership.full[t]) add_tet(elements, t, shares, entries);
  for (std::size_t c = 0; c < membership.embedded.size(); ++c)
    if (!membership.embedded[c].empty())
      add_cell(lattice,
               make_cell(elements, lattice, static_cast<Index>(c), membership.embedded[c], stiffening),
               static_cast<Index>(c), unknowns, elements.elastic_of(membership.embedded[c].front()), entries);
  system.K.resize(3 * count, 3 * count);
  system.K.setFromTriplets(entries.begin(), entries.end());
  double trace = 0;
  for (Index i = 0; i < 3 * count; ++i) trace += system.K.coeff(i, i);
  for (Index i = 0; i < 3 * count; ++i) system.K.coeffRef(i, i) += 1e-9 * trace / (3 * count);
  return system;
}

}  // namespace

// Inverse iterations on a subspace. [Bathe, Finite Element Procedures, section 11.6]
std::vector<double> lowest_frequencies(const Elements& elements, const Lattice& lattice,
                                       const Membership& membership, Stiffening stiffening, int count) {
  const System system = assemble(elements, lattice, membership, stiffening);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(system.K);
  const auto size = system.M.size();
  const int kept = 2 * count;
  Eigen::MatrixXd X(size, kept);
  for (Eigen::Index i = 0; i < size; ++i)
    for (int k = 0; k < kept; ++k) X(i, k) = std::sin(double(i + 1) * (k + 1) * 0.7548776662);
  Eigen::VectorXd squares;
  for (int iteration = 0; iteration < 12; ++iteration) {
    X = factor.solve(Eigen::MatrixXd(system.M.asDiagonal() * X)).eval();
    const Eigen::MatrixXd MX = system.M.asDiagonal() * X;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> small(X.transpose() * (system.K * X),
                                                                          X.transpose() * MX);
    X = (X * small.eigenvectors()).eval();
    squares = small.eigenvalues();
  }
  std::vector<double> omegas;
  for (int k = 0; k < count; ++k) omegas.push_back(std::sqrt(squares[k]));
  return omegas;
}

}  // namespace lobe::reduced
