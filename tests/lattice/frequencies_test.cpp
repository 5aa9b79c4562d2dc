// Natural frequencies of a free block at rest, all of it embedded, against those of its own tetrahedra.
#include <doctest/doctest.h>

#include <algorithm>

#include "lattice_support.h"
#include "lobe/fem/hooke.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/solve/tangent.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double block_edge = 0.01;

Setup block_setup(double lambda) {
  TetMesh mesh = box_mesh({10 * block_edge, 6 * block_edge, 4 * block_edge}, 10, 6, 4);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.15 * block_edge, 0.15 * block_edge);
  for (double& x : mesh.points.reshaped()) x += jitter(random);
  Setup setup = reduced_setup(mesh, 2 * block_edge);
  setup.materials[0].lambda = lambda;
  return setup;
}

// Those of K x = ω² M x, without the six of rigid motions [rad/s].
Eigen::VectorXd lowest(const Eigen::MatrixXd& K, const std::vector<double>& mass, int count) {
  Eigen::VectorXd roots(K.rows());
  for (Eigen::Index i = 0; i < roots.size(); ++i) roots[i] = 1 / std::sqrt(mass[std::size_t(i / 3)]);
  const Eigen::MatrixXd scaled = roots.asDiagonal() * K * roots.asDiagonal();
  return symmetric_eigenvalues(scaled).segment(6, count).cwiseSqrt();
}

void add(Index row, Index column, const Mat3<double>& block, Eigen::MatrixXd& K) {
  K.block<3, 3>(3 * row, 3 * column) += block;
}

Eigen::MatrixXd stiffness_of_tets(const Elements& elements) {
  const Index size = 3 * elements.topology.vertex_count();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    const Shape s = elements.shape_of(t);
    const Elastic& e = elements.elastic_of(t);
    const Eigen::Vector4i corners = elements.topology.corners(t);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k)
        add(corners[j], corners[k],
            s.volume * hooke_block<double>(s.gradients.col(j), s.gradients.col(k), e.lambda, e.mu), K);
  }
  return K;
}

Eigen::MatrixXd stiffness_of_cells(const EmbeddedBox& box) {
  const Index size = 3 * box.lattice.node_count();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
  for (const LatticeCell& cell : box.embedding.cells) {
    const Elastic& e = box.elements.elastic_of(cell.tet);
    const auto& nodes = box.lattice.parts[std::size_t(cell.part)].nodes;
    for (int n = 0; n < 8; ++n)
      for (int m = 0; m < 8; ++m)
        add(nodes[std::size_t(n)], nodes[std::size_t(m)],
            cell.volume * hooke_block<double>(cell.gradients.row(n).transpose(),
                                              cell.gradients.row(m).transpose(), e.lambda, e.mu) +
                cell.fluctuation(n, m) * Mat3<double>::Identity(),
            K);
  }
  return K;
}

}  // namespace

namespace {

Eigen::MatrixXd tangent_at_rest(const Elements& elements) {
  const Unknowns all(elements.topology.vertex_count(), [](Index, int) { return true; });
  Tangent tangent(elements, all);
  tangent.update(Mat3X<double>::Zero(3, elements.topology.vertex_count()));
  return Eigen::MatrixXd(tangent.matrix()).selfadjointView<Eigen::Lower>();
}

// Of the lowest frequencies, relative to those of the tetrahedra; μ = 10⁴ Pa.
Eigen::VectorXd errors(double lambda, ElementType element = ElementType::tetrahedron) {
  Setup setup = block_setup(lambda);
  setup.materials[0].element = element;
  EmbeddedBox box(setup, 0);
  give_mass(box.elements, box.lattice, box.vertex_masses(), 0, {}, box.embedding);
  const bool is_plain = element == ElementType::tetrahedron;
  const Eigen::VectorXd exact = lowest(
      is_plain ? stiffness_of_tets(box.elements) : tangent_at_rest(box.elements), box.vertex_masses(), 5);
  const Eigen::VectorXd found = lowest(stiffness_of_cells(box), box.embedding.mass, 5);
  CHECK(exact[0] > 1);
  const Eigen::VectorXd error = found.cwiseQuotient(exact).array() - 1;
  MESSAGE("lambda / mu " << lambda / 1e4 << ": " << (100 * error).transpose() << " %");
  return error;
}

}  // namespace

TEST_CASE("a lattice has the lowest natural frequencies of its tetrahedra") {
  for (const double lambda : {1e4, 4e4}) {
    const Eigen::VectorXd error = errors(lambda);
    CHECK(error.cwiseAbs().maxCoeff() < 0.09);
    CHECK(error.cwiseAbs().mean() < 0.05);
  }
}

TEST_CASE("a lattice has the natural frequencies of edge-smoothed tetrahedra, but for the lowest") {
  for (const double lambda : {1e4, 4e4}) {
    const Eigen::VectorXd error = errors(lambda, ElementType::edge_smoothed);
    CHECK(error[0] > 0.05);
    CHECK(error[0] < 0.15);
    CHECK(error.tail(4).cwiseAbs().maxCoeff() < 0.05);
  }
}

TEST_CASE("where tetrahedra lock, a lattice of two cells across is too stiff in the lowest mode alone") {
  const Eigen::VectorXd error = errors(50e4);
  CHECK(error[0] > 0.09);
  CHECK(error[0] < 0.4);
  CHECK(error.tail(4).cwiseAbs().maxCoeff() < 0.06);
}
