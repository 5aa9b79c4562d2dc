// The factorisation of symmetric matrices that Newton's method asks for, behind one interface, so that other
// back ends can be linked in (cholmod/ has one under the GPL).
#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <memory>
#include <vector>

namespace lobe {

class SparseFactor {
 public:
  using Matrix = Eigen::SparseMatrix<double>;  // lower triangle, compressed

  virtual ~SparseFactor() = default;
  virtual const char* name() const = 0;  // method and ordering, for reports
  virtual bool takes_indefinite() const = 0;

  virtual void analyse(const Matrix& A) = 0;  // finds the ordering for a pattern
  // A = L D Lᵀ for a matrix of the pattern analysed. False if A is singular to rounding or does not have
  // exactly `negative` negative eigenvalues.
  virtual bool factorise(const Matrix& A, Eigen::Index negative = 0) = 0;
  virtual Eigen::Index size() const = 0;  // rows of A
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& b) const = 0;
  virtual Eigen::MatrixXd solve_all(const Eigen::MatrixXd& B) const;  // column by column
  // Returns rows × columns of A⁻¹, both by their numbers in A.
  virtual Eigen::MatrixXd inverse_block(const std::vector<int>& rows, const std::vector<int>& columns) const;
  virtual long long nonzeros() const = 0;  // entries of the factor
};

using SparseFactorMaker = std::function<std::unique_ptr<SparseFactor>()>;

// Simplicial L D Lᵀ of Eigen, in the order of fill_ordering.h. It takes indefinite matrices.
std::unique_ptr<SparseFactor> make_ldlt();

}  // namespace lobe
