#include "lobe/numerics/dense_products.h"

namespace lobe {
namespace {

MatrixFactor<double> entries_of(const DenseProducts::Factor& factor) {
  const auto stride = std::size_t(factor.matrix.outerStride());
  return factor.is_transposed ? MatrixFactor<double>{factor.matrix.data(), stride, 1}
                              : MatrixFactor<double>{factor.matrix.data(), 1, stride};
}

}  // namespace

void DenseProducts::add(double sign, const Factor& A, const Factor& B, bool lower, Eigen::Ref<Matrix> C) {
  const auto depth = static_cast<Index>(A.is_transposed ? A.matrix.rows() : A.matrix.cols());
  const auto rows = static_cast<Index>(C.rows()), columns = static_cast<Index>(C.cols());
  if (depth == 0 || rows == 0 || columns == 0) return;
  scratch_.resize(std::max(scratch_.size(), product_scratch(columns)));
  kernels_.add_product({sign, entries_of(A), entries_of(B), rows, depth, columns, lower, C.data(),
                        std::size_t(C.outerStride())},
                       scratch_.data());
}

void DenseProducts::add(double sign, const Factor& A, const Factor& B, Eigen::Ref<Matrix> C) {
  add(sign, A, B, false, C);
}

void DenseProducts::add_symmetric(double sign, const Factor& A, const Factor& B, Eigen::Ref<Matrix> C) {
  add(sign, A, B, true, C);
  C.triangularView<Eigen::StrictlyUpper>() = C.transpose();
}

DenseProducts::Matrix DenseProducts::product(const Factor& A, const Factor& B) {
  Matrix C = Matrix::Zero(A.is_transposed ? A.matrix.cols() : A.matrix.rows(),
                          B.is_transposed ? B.matrix.rows() : B.matrix.cols());
  add(1, A, B, C);
  return C;
}

}  // namespace lobe
