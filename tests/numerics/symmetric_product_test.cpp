#include "lobe/numerics/symmetric_product.h"

#include <doctest/doctest.h>

#include <cstdlib>

using namespace lobe;

namespace {

Eigen::MatrixXd symmetric(Index n) {
  const Eigen::MatrixXd any = Eigen::MatrixXd::Random(n, n);
  return any + any.transpose();
}

template <class Real>
std::vector<Real> product(const Eigen::MatrixXd& S, const Eigen::VectorXd& x, InstructionSet set,
                          int threads = 1) {
  SymmetricProduct<Real> own(set);
  own.set(S);
  for (Index i = 0; i < own.size(); ++i) own.x()[std::size_t(i)] = Real(x[i]);
  Parallel parallel(threads);
  return own.multiply(parallel);
}

template <class Real>
void check_product(Index n, double tolerance) {
  const Eigen::MatrixXd S = symmetric(n);
  const Eigen::VectorXd x = Eigen::VectorXd::Random(n), expected = S * x;
  const std::vector<Real> baseline = product<Real>(S, x, InstructionSet::baseline);
  for (Index i = 0; i < n; ++i)
    CHECK(std::abs(double(baseline[std::size_t(i)]) - expected[i]) < tolerance * std::sqrt(double(n)));
  for (InstructionSet set : available_instruction_sets())
    for (int threads : {1, 2, 7}) CHECK(product<Real>(S, x, set, threads) == baseline);
}

}  // namespace

TEST_CASE("half of a symmetric matrix gives the product of the whole one, to the bit on all processors") {
  for (Index n : {0, 1, 7, 8, 9, 15, 16, 17, 31, 33, 100, 257, 1500}) {
    CAPTURE(n);
    check_product<float>(n, 2e-5);
    check_product<double>(n, 1e-13);
  }
}
