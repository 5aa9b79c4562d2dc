// The product of a dense symmetric matrix with a vector. Every step of a condensed region takes one. Only the
// half below the diagonal is read: 2 n² bytes in single precision, at the speed of the cache or memory that
// holds them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lobe/numerics/dense_kernels.h"
#include "lobe/parallel.h"

namespace lobe {

template <class Real>
class SymmetricProduct {
 public:
  explicit SymmetricProduct(InstructionSet set = chosen_instruction_set())
      : kernels_(dense_kernels<Real>(set)) {}

  void set(const Eigen::Ref<const Eigen::MatrixXd>& S);  // reads the lower triangle of S

  Index size() const { return shape_.size; }
  std::size_t bytes() const { return tiles_.size() * sizeof(Real); }  // bytes that a product reads
  std::vector<Real>& x() { return x_; }                               // at least size(), the rest stays 0
  // Returns S x, with the same bits on any number of threads.
  const std::vector<Real>& multiply(Parallel& parallel);

 private:
  void divide();

  DenseKernels<Real> kernels_;
  SymmetricHalf shape_;
  std::vector<Real> tiles_, diagonal_;
  std::vector<Index> parts_ = {0};  // begin of each part in the panels, and the end
  std::vector<Real> x_, y_, sums_;  // y; y of each part
};

}  // namespace lobe
