#include "lobe/solve/sparse_factor.h"

#include <Eigen/SparseCholesky>
#include <iostream>  // Eigen's MetisSupport needs it

#include <Eigen/MetisSupport>

namespace lobe {
namespace {

class Ldlt : public SparseFactor {
 public:
  const char* name() const override { return "Eigen simplicial LDLT, METIS nested dissection"; }
  bool takes_indefinite() const override { return true; }
  void analyse(const Matrix& A) override { factor_.analyzePattern(A); }

  // By Sylvester's law D has as many negative entries as A has negative eigenvalues.
  bool factorise(const Matrix& A, Eigen::Index negative) override {
    factor_.factorize(A);
    if (factor_.info() != Eigen::Success) return false;
    const Eigen::VectorXd D = factor_.vectorD();
    return D.allFinite() && (D.array() < 0).count() == negative;
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const override { return factor_.solve(b); }
  long long nonzeros() const override { return factor_.matrixL().nestedExpression().nonZeros(); }

 private:
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::MetisOrdering<int>> factor_;
};

}  // namespace

std::unique_ptr<SparseFactor> make_ldlt() { return std::make_unique<Ldlt>(); }

}  // namespace lobe
