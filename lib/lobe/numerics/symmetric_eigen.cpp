#include "lobe/numerics/symmetric_eigen.h"

#include <Eigen/Eigenvalues>

namespace lobe {

template <class Matrix>
SymmetricEigen<Matrix> symmetric_eigen(const Matrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template <class Matrix>
ColumnOf<Matrix> symmetric_eigenvalues(const Matrix& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricEigen<Mat3<double>> direct_symmetric_eigen(const Mat3<double>& symmetric) {
  Eigen::SelfAdjointEigenSolver<Mat3<double>> solver;
  solver.computeDirect(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Vec3d direct_symmetric_eigenvalues(const Mat3<double>& symmetric) {
  Eigen::SelfAdjointEigenSolver<Mat3<double>> solver;
  solver.computeDirect(symmetric, Eigen::EigenvaluesOnly);
  return solver.eigenvalues();
}

double largest_eigenvalue(const Mat3<double>& symmetric) {
  return direct_symmetric_eigenvalues(symmetric)[2];
}

template SymmetricEigen<Mat3<double>> symmetric_eigen(const Mat3<double>&);
template SymmetricEigen<Eigen::Matrix4d> symmetric_eigen(const Eigen::Matrix4d&);
template SymmetricEigen<Eigen::MatrixXd> symmetric_eigen(const Eigen::MatrixXd&);
template Vec3d symmetric_eigenvalues(const Mat3<double>&);
template Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd&);

}  // namespace lobe
