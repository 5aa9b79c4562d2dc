// Eigenvalues and eigenvectors of symmetric matrices, by Eigen's solvers. They take seconds to compile, and
// are compiled here once. All read only the lower triangle of the matrix.
#pragma once

#include "lobe/types.h"

namespace lobe {

template <class Matrix>
using ColumnOf = Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1>;

template <class Matrix>
struct SymmetricEigen {
  ColumnOf<Matrix> values;  // eigenvalues in ascending order
  Matrix vectors;           // one column per value, of length 1
};

// Found by QR iterations, exact to rounding. `Matrix`: Mat3<double>, Eigen::Matrix4d or Eigen::MatrixXd.
template <class Matrix>
SymmetricEigen<Matrix> symmetric_eigen(const Matrix& symmetric);
template <class Matrix>
ColumnOf<Matrix> symmetric_eigenvalues(const Matrix& symmetric);

// Found by the closed formula for 3 × 3, which is faster and less exact: values that are close to each other
// may lose half of their digits.
SymmetricEigen<Mat3<double>> direct_symmetric_eigen(const Mat3<double>& symmetric);
Vec3d direct_symmetric_eigenvalues(const Mat3<double>& symmetric);
double largest_eigenvalue(const Mat3<double>& symmetric);  // the last of these

}  // namespace lobe
