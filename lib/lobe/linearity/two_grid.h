// Approximate solutions of an equation of a body at rest, (s K + w M) x = f, by one cycle over two grids
// (A. Brandt, Multi-level adaptive solutions to boundary-value problems, 1977). The fine one is the mesh. The
// coarse one is a lattice over all tetrahedra, with trilinear functions (lattice.h). M is lumped.
//
// Held components of x are zero. On the lattice they are springs, stiffer than the vertex is at rest.
#pragma once

#include <functional>

#include "lobe/lattice/lattice.h"
#include "lobe/numerics/sparse_factor.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

class TwoGrid {
 public:
  // `edge`: edge of the lattice's cells [m]. Costs some microseconds per tetrahedron.
  TwoGrid(const Elements& elements, double edge);

  // Sets the equation and what is held. The first call factors the lattice's matrix without what tools hold.
  // After later calls, and where tools hold something, its equations are solved by conjugate gradients with
  // that factor.
  void prepare(const HeldVertices& held, double s, double w);  // w [1/s²]

  // Gives K x [N]; all are 3 × #vertices.
  using Product = std::function<Mat3X<double>(const Mat3X<double>& x)>;
  Mat3X<double> solve(const Product& product, const Mat3X<double>& f) const;  // takes two products

  void clear_held(Mat3X<double>& x) const;  // makes its held components zero

  Index vertex_count() const { return static_cast<Index>(mass_.size()); }  // in its mesh
  const std::vector<double>& mass() const { return mass_; }                // per vertex [kg]

 private:
  bool moves(Index v) const { return v < vertex_count() && lattice_.part_of_vertex[std::size_t(v)] >= 0; }
  const std::array<Index, 8>& nodes_of(Index v) const {
    return lattice_.parts[std::size_t(lattice_.part_of_vertex[std::size_t(v)])].nodes;
  }
  void find_masses(const Elements& elements);
  void find_diagonal(const Elements& elements);
  void find_stiffness(const Elements& elements);
  void add_spring(const HeldVertices::Held& item, SparseFactor::Matrix& A);
  Eigen::VectorXd solve_lattice(const Eigen::VectorXd& f) const;
  // Returns f − (s K + w M) x.
  Mat3X<double> left(const Product& product, const Mat3X<double>& f, const Mat3X<double>& x) const;
  // The displacements that forces make, vertex by vertex and by the lattice alone.
  Mat3X<double> relaxed(Mat3X<double> f) const;
  Mat3X<double> of_lattice(Mat3X<double> f) const;

  Lattice lattice_;
  std::vector<CellWeights> weights_;    // weights of each vertex
  std::vector<Mat3<double>> diagonal_;  // K_vv [N/m]
  std::vector<double> mass_, node_mass_;
  SparseFactor::Matrix stiffness_;  // stiffness of nodes, lower triangle [N/m]
  double s_ = 1, w_ = 0;
  Eigen::Matrix<bool, 3, Eigen::Dynamic> is_held_;
  std::vector<Mat3<double>> relaxation_;  // ω (s K_vv + w m_v)⁻¹ of each vertex
  SparseFactor::Matrix matrix_;           // s K + w M of the lattice, and springs
  std::unique_ptr<SparseFactor> factor_;  // none where no tetrahedron is left
  enum class Factor { none, failed, near, exact };
  Factor factored_ = Factor::none;  // the factor of matrix_; failed: it is not positive definite
};

}  // namespace lobe
