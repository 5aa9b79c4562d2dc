#include "lobe/numerics/supernodal_factor.h"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <numeric>

#include "lobe/condense/region_factor.h"
#include "lobe/numerics/supernodes.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

SparseFactor::Matrix stiffness(int n) {
  Setup setup = setup_of(irregular_box(n), RegionModel::precomputed);
  const Elements elements(setup);
  Roles roles = Roles::Constant(3, setup.mesh.vertex_count(), Role::interior);
  roles.leftCols((n + 1) * (n + 1)).setConstant(Role::interface);
  return RegionFactor(elements, roles).K;
}

double entries(const Supernodes& nodes) {
  double sum = 0;
  for (int s = 0; s < nodes.count(); ++s)
    sum += nodes.width(s) * (0.5 * nodes.width(s) + double(nodes.below[std::size_t(s)].size()));
  return sum;
}

}  // namespace

TEST_CASE("supernodes hold about what the factor of a simplicial method does") {
  const SparseFactor::Matrix K = stiffness(8);
  const Supernodes nodes = find_supernodes(K);
  const auto simplicial = make_ldlt();
  simplicial->analyse(K);
  REQUIRE(simplicial->factorise(K));
  CHECK(entries(nodes) < 1.2 * double(simplicial->nonzeros()));
  CHECK(entries(nodes) > 0.8 * double(simplicial->nonzeros()));
  CHECK(nodes.count() < K.cols() / 9);
}

TEST_CASE("the supernodal factor solves as the simplicial one, and gives the same blocks of the inverse") {
  for (int n : {1, 2, 5, 8}) {
    CAPTURE(n);
    const SparseFactor::Matrix K = stiffness(n);
    const auto simplicial = make_ldlt(), supernodal = make_supernodal();
    for (const auto* factor : {&simplicial, &supernodal}) {
      (*factor)->analyse(K);
      REQUIRE((*factor)->factorise(K));
    }
    const Eigen::VectorXd b = Eigen::VectorXd::Random(K.cols()), x = supernodal->solve(b);
    CHECK((x - simplicial->solve(b)).norm() < 1e-11 * x.norm());
    const Eigen::MatrixXd B = Eigen::MatrixXd::Random(K.cols(), 131), X = supernodal->solve_all(B);
    CHECK((X - simplicial->solve_all(B)).norm() < 1e-11 * X.norm());
    std::vector<int> rows, columns;
    for (int i = 0; i < K.cols(); i += 3) rows.push_back(i);
    for (int i = static_cast<int>(K.cols()) - 1; i >= 0; i -= 5) columns.push_back(i);
    const Eigen::MatrixXd block = supernodal->inverse_block(rows, columns);
    CHECK((block - simplicial->inverse_block(rows, columns)).norm() < 1e-11 * block.norm());
  }
}

TEST_CASE("a stiffness that is singular or indefinite has no supernodal factor") {
  SparseFactor::Matrix K = stiffness(4);
  const auto factor = make_supernodal();
  factor->analyse(K);
  REQUIRE(factor->factorise(K));
  K.coeffRef(50, 50) *= -1;
  CHECK_FALSE(factor->factorise(K));
  const Setup setup = setup_of(irregular_box(4), RegionModel::precomputed);
  const Roles floats = Roles::Constant(3, setup.mesh.vertex_count(), Role::interior);
  const SparseFactor::Matrix floating = RegionFactor(Elements(setup), floats).K;
  factor->analyse(floating);
  CHECK_FALSE(factor->factorise(floating));
}
