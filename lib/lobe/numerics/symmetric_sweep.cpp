#include "lobe/numerics/symmetric_sweep.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace lobe {
namespace {

using Matrix = DenseProducts::Matrix;

constexpr Eigen::Index most = 96;  // components that are swept at once

// K −= A Bᵀ, symmetric, below the diagonal: by panels of columns.
void subtract_lower(const Matrix& A, const Matrix& B, Matrix& K, DenseProducts& products) {
  constexpr Eigen::Index width = 192;
  for (Eigen::Index j = 0; j < K.cols(); j += width) {
    const Eigen::Index columns = std::min(width, K.cols() - j), rows = K.rows() - j;
    products.add(-1, {A.bottomRows(rows)}, {B.middleRows(j, columns), true}, K.block(j, j, rows, columns));
  }
}

}  // namespace

bool sweep(Matrix& K, Eigen::Index swept, double loose, DenseProducts& products) {
  const Eigen::Index n = K.rows();
  const Eigen::ArrayXd diagonal = K.diagonal();
  for (Eigen::Index k = 0; k < swept; k += most) {
    const Eigen::Index count = std::min(most, swept - k), after = n - k - count;
    Matrix pivots(n, count);
    pivots.topRows(k) = K.middleRows(k, count).leftCols(k).transpose();
    pivots.bottomRows(n - k) = K.middleCols(k, count).bottomRows(n - k);
    Matrix pivot = pivots.middleRows(k, count).selfadjointView<Eigen::Lower>();
    const Eigen::LLT<Matrix> factor(pivot);
    const auto L = factor.matrixLLT().diagonal().array();
    if (factor.info() != Eigen::Success || !(L.square() > loose * diagonal.segment(k, count)).all())
      return false;
    pivot = factor.solve(Matrix::Identity(count, count));
    const Matrix left = products.product({pivots}, {pivot});
    subtract_lower(left, pivots, K, products);
    K.middleRows(k, count).leftCols(k) = left.topRows(k).transpose();
    K.middleCols(k, count).bottomRows(after) = left.bottomRows(after);
    K.block(k, k, count, count) = -pivot;
  }
  return true;
}

bool invert(Matrix& K, double loose, DenseProducts& products) {
  if (!sweep(K, K.rows(), loose, products)) return false;
  K = -Matrix(K.selfadjointView<Eigen::Lower>());
  return true;
}

}  // namespace lobe
