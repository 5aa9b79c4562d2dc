#include "lobe/solve/tangent_factor.h"

#include <cmath>

namespace lobe {
namespace {

// A factor for a problem without unknowns, because orderings do not take a graph without vertices.
class NothingUnknown : public SparseFactor {
 public:
  const char* name() const override { return "none"; }
  bool takes_indefinite() const override { return true; }
  void analyse(const Matrix&) override {}
  bool factorise(const Matrix&, Eigen::Index) override { return true; }
  Eigen::Index size() const override { return 0; }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const override { return b; }
  long long nonzeros() const override { return 0; }
};

}  // namespace

std::unique_ptr<SparseFactor> make_tangent_factor(const SparseFactorMaker& wanted,
                                                  const SparseFactor::Matrix& matrix, bool is_indefinite) {
  if (matrix.rows() == 0) return std::make_unique<NothingUnknown>();
  std::unique_ptr<SparseFactor> factor = wanted();
  if (is_indefinite && !factor->takes_indefinite()) factor = make_ldlt();
  factor->analyse(matrix);
  return factor;
}

bool factorise_damped(SparseFactor& factor, SparseFactor::Matrix& matrix, Index unknowns, Index negative,
                      bool& damped) {
  bool is_right = factor.factorise(matrix, negative);
  damped = !is_right;
  const Eigen::VectorXd diagonal = matrix.diagonal().head(unknowns);
  for (double shift = 1e-3; !is_right && shift < 1e6; shift *= 4) {
    for (Index i = 0; i < unknowns; ++i)
      matrix.valuePtr()[matrix.outerIndexPtr()[i]] = diagonal[i] + shift * std::abs(diagonal[i]);
    is_right = factor.factorise(matrix, negative);
  }
  return is_right;
}

}  // namespace lobe
