#include "benchmarks/validation/quadrature.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace lobe;
using namespace lobe::validation;

// Means over a simplex of dimension d: ∏ a_i! d! / (Σ a_i + d)!
double exact_mean(int dimension, const Eigen::VectorXi& powers) {
  double mean = std::tgamma(dimension + 1) / std::tgamma(powers.sum() + dimension + 1);
  for (int a : powers) mean *= std::tgamma(a + 1);
  return mean;
}

double monomial(const Eigen::VectorXd& x, const Eigen::VectorXi& powers) {
  double product = 1;
  for (Eigen::Index i = 0; i < x.size(); ++i) product *= std::pow(x[i], powers[i]);
  return product;
}

TEST_CASE("the tetrahedron's points integrate every monomial of degree 5 exactly, and not all of degree 6") {
  const auto error = [](const Eigen::Vector4i& powers) {
    double sum = 0;
    for (const TetPoint& q : tet_quadrature()) sum += q.weight * monomial(q.barycentric, powers);
    return std::abs(sum - exact_mean(3, powers));
  };
  for (int a = 0; a <= 5; ++a)
    for (int b = 0; a + b <= 5; ++b)
      for (int c = 0; a + b + c <= 5; ++c) CHECK(error({a, b, c, 5 - a - b - c}) < 1e-15);
  CHECK(error({6, 0, 0, 0}) > 1e-6);
}

TEST_CASE("the triangle's points integrate every monomial of degree 4 exactly, and not all of degree 5") {
  const auto error = [](const Eigen::Vector3i& powers) {
    double sum = 0;
    for (const TrianglePoint& q : triangle_quadrature()) sum += q.weight * monomial(q.barycentric, powers);
    return std::abs(sum - exact_mean(2, powers));
  };
  for (int a = 0; a <= 4; ++a)
    for (int b = 0; a + b <= 4; ++b) CHECK(error({a, b, 4 - a - b}) < 1e-15);
  CHECK(error({5, 0, 0}) > 1e-6);
}
