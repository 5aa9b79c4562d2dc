// Products of large dense matrices, in double precision, by the wide kernels: the same bits on every
// processor.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lobe/numerics/dense_kernels.h"

namespace lobe {

class DenseProducts {
 public:
  using Matrix = Eigen::MatrixXd;
  struct Factor {
    Eigen::Ref<const Matrix> matrix;
    bool is_transposed = false;
  };

  explicit DenseProducts(InstructionSet set = chosen_instruction_set())
      : kernels_(dense_kernels<double>(set)) {}

  void add(double sign, const Factor& A, const Factor& B, Eigen::Ref<Matrix> C);  // C += sign A B
  // C += sign A B where A B and C are symmetric. Half of it is computed, and copied to the other half.
  void add_symmetric(double sign, const Factor& A, const Factor& B, Eigen::Ref<Matrix> C);
  Matrix product(const Factor& A, const Factor& B);

 private:
  void add(double sign, const Factor& A, const Factor& B, bool lower, Eigen::Ref<Matrix> C);

  DenseKernels<double> kernels_;
  std::vector<double> scratch_;
};

}  // namespace lobe
