#include "lobe/solve/tangent.h"

#include <doctest/doctest.h>

#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// ∂²W/∂u² with nodal pressures eliminated.
Eigen::MatrixXd dense(const Tangent& tangent, Index unknowns) {
  const Eigen::MatrixXd A = Eigen::MatrixXd(tangent.matrix()).selfadjointView<Eigen::Lower>();
  const Index pressures = static_cast<Index>(A.rows()) - unknowns;
  if (pressures == 0) return A;
  const Eigen::MatrixXd G = A.bottomLeftCorner(pressures, unknowns),
                        C = -A.bottomRightCorner(pressures, pressures);
  return A.topLeftCorner(unknowns, unknowns) + G.transpose() * C.inverse() * G;
}

}  // namespace

TEST_CASE("the tangent is the derivative of the forces, in every region, stretched and compressed") {
  const TetMesh mesh = irregular_box(2);
  for (const auto& [share, element, law] : {std::tuple{0.0, ElementType::tetrahedron, MaterialLaw::svk},
                                            {0.7, ElementType::tetrahedron, MaterialLaw::svk},
                                            {0.7, ElementType::tetrahedron, MaterialLaw::mooney_rivlin},
                                            {0.0, ElementType::edge_smoothed, MaterialLaw::svk},
                                            {0.7, ElementType::edge_smoothed, MaterialLaw::svk},
                                            {0.7, ElementType::edge_smoothed, MaterialLaw::neo_hookean}}) {
    Setup setup = hybrid_setup(mesh);
    setup.materials[1].law = law;
    if (law == MaterialLaw::mooney_rivlin) setup.materials[1].further[0] = setup.materials[1].mu / 5;
    setup.materials[1].nodal_pressure = share;
    setup.materials[1].element = element;
    setup.guard_below = 0.5;
    const Elements elements(setup);
    for (double size : {1e-3, 4e-3}) {
      const Mat3X<double> u = random_displacement(mesh.vertex_count(), size);
      const Unknowns everything(mesh.vertex_count(), [](Index, int) { return true; });
      Tangent tangent(elements, everything);
      tangent.update(
          random_displacement(mesh.vertex_count(), size, 8));  // what an earlier state leaves behind
      tangent.update(u);
      const Eigen::MatrixXd K = dense(tangent, everything.count);
      if (size > 2e-3) CHECK(energy_and_forces(elements, u).smallest_volume_ratio < 0.2);  // guarded
      const double h = 1e-8;
      for (Index i = 0; i < u.size(); ++i) {
        Mat3X<double> plus = u, minus = u;
        plus(i) += h;
        minus(i) -= h;
        const Mat3X<double> slope = (energy_and_forces(elements, tangent.averages(), minus).forces -
                                     energy_and_forces(elements, tangent.averages(), plus).forces) /
                                    (2 * h);
        CHECK((K.col(i) - slope.reshaped()).norm() < 1e-6 * K.norm());
      }
    }
  }
}

TEST_CASE("a tetrahedron's stiffness is symmetric and costs a translation nothing") {
  const TetMesh mesh = irregular_box(1);
  const Elements elements(hybrid_setup(mesh));
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> u = random_displacement(4, 3e-3, unsigned(t));
    const TetStiffness K = tet_stiffness(elements, t, u);
    CHECK((K - K.transpose()).norm() < 1e-14 * K.norm());
    for (int d = 0; d < 3; ++d) {
      Eigen::Matrix<double, 12, 1> move;
      move << Vec3d::Unit(d), Vec3d::Unit(d), Vec3d::Unit(d), Vec3d::Unit(d);
      CHECK((K * move).norm() < 1e-13 * K.norm());
    }
  }
}
