#include "lobe/numerics/dense_products.h"

#include <doctest/doctest.h>

#include "lobe/numerics/symmetric_sweep.h"

using namespace lobe;

namespace {

using Matrix = Eigen::MatrixXd;

Matrix oriented(const Matrix& M, bool transposed) { return transposed ? Matrix(M.transpose()) : M; }

}  // namespace

TEST_CASE("dense products are Eigen's, and the same to the bit on all processors") {
  for (const auto& size : {std::array{1, 1, 1},
                           {3, 5, 2},
                           {16, 192, 8},
                           {17, 193, 9},
                           {300, 40, 21},
                           {61, 500, 130},
                           {0, 4, 4},
                           {4, 0, 4}})
    for (bool left : {false, true})
      for (bool right : {false, true}) {
        const int rows = size[0], depth = size[1], columns = size[2];
        CAPTURE(rows);
        CAPTURE(depth);
        CAPTURE(columns);
        const Matrix A = Matrix::Random(rows, depth), B = Matrix::Random(depth, columns);
        const Matrix given = Matrix::Random(rows + 2, columns), A_given = oriented(A, left),
                     B_given = oriented(B, right);
        Matrix first;
        for (InstructionSet set : available_instruction_sets()) {
          Matrix C = given;
          DenseProducts(set).add(-1, {A_given, left}, {B_given, right}, C.topRows(rows));
          Matrix expected = given;
          expected.topRows(rows) -= A * B;
          CHECK((C - expected).cwiseAbs().maxCoeff() < 1e-14 * (1 + depth));
          if (first.size() == 0) first = C;
          CHECK(C == first);
        }
      }
}

TEST_CASE("the inverse of a stiffness is that of a Cholesky factor, and a mechanism has none") {
  DenseProducts products;
  for (int n : {1, 7, 96, 97, 300}) {
    const Matrix B = Matrix::Random(n, n + 3);
    Matrix K = B * B.transpose() + Matrix::Identity(n, n), inverse = K;
    REQUIRE(invert(inverse, 1e-10, products));
    CHECK((inverse * K - Matrix::Identity(n, n)).norm() < 1e-11 * n);
    CHECK(inverse == Matrix(inverse.transpose()));
    K.row(n - 1).setZero();
    K.col(n - 1).setZero();
    CHECK_FALSE(invert(K, 1e-10, products));
  }
}

TEST_CASE("half of a symmetric product is enough") {
  const Matrix A = Matrix::Random(40, 25), C = A * A.transpose(), B = Matrix::Random(40, 40);
  Matrix sum = B + B.transpose();
  const Matrix expected = sum - C;
  DenseProducts().add_symmetric(-1, {A}, {A, true}, sum);
  CHECK((sum - expected).cwiseAbs().maxCoeff() < 1e-13);
  CHECK(sum == Matrix(sum.transpose()));
}
