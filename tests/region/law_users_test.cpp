// All that evaluates a tetrahedron follows its law (fem/law.h), here with all terms at once.
#include <doctest/doctest.h>

#include "lobe/diagnostics/fields.h"
#include "lobe/fem/hooke.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/linearity/defect.h"
#include "lobe/region/nonlinear.h"
#include "lobe/solve/tangent.h"
#include "lobe/time/vertex_frequencies.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// One tetrahedron alone, compressed to where the guard resists. Its nodes all have a quarter of its volume,
// and the same pressure.
struct OneTetrahedron {
  OneTetrahedron() {
    TetMesh mesh;
    mesh.points.resize(3, 4);
    mesh.points << 0, 0.009, 0.001, 0.002, 0, 0.002, 0.011, 0.001, 0, -0.001, 0.002, 0.008;
    mesh.tets.resize(4, 1);
    mesh.tets << 0, 1, 2, 3;
    mesh.labels = {0};
    setup = averaged(setup_of(mesh), 0.4);
    setup.volume_penalty = 1e5;
    setup.guard_below = 0.8;
    u = -0.15 * mesh.points + random_displacement(4, 1e-3);
    const Mat34<double> corners = u;
    const Elements elements(setup);
    s = elements.shape_of(0);
    H = displacement_gradient<double>(corners, s.gradients.rightCols<3>());
    law = nonlinear_law(elements, 0, seed_material.lambda * 0.4 * strain_trace(H));
  }

  Setup setup;
  Mat3X<double> u;
  Shape s;
  Mat3<double> H;
  Law<double> law;
};

template <class A, class B>
double difference(const A& a, const B& b) {
  return (a - b).norm() / b.norm();
}

Eigen::Matrix<double, 6, 1> upper(const Mat3<double>& K) {
  return {K(0, 0), K(0, 1), K(0, 2), K(1, 1), K(1, 2), K(2, 2)};
}

}  // namespace

TEST_CASE("the law of a tetrahedron has all terms, and each counts") {
  const OneTetrahedron one;
  CHECK(one.law.terms == Terms{MaterialLaw::svk, true, true, true});
  CHECK(is_guarded(one.law, one.H));
  Law<double> without_solid = one.law;
  without_solid.terms.solid = MaterialLaw::none;
  CHECK(difference(law_stress(without_solid, one.H), law_stress(one.law, one.H)) > 1e-3);
  for (bool Terms::*term : {&Terms::volume, &Terms::pressure, &Terms::guard}) {
    Law<double> without = one.law;
    without.terms.*term = false;
    CHECK(difference(law_stress(without, one.H), law_stress(one.law, one.H)) > 1e-3);
  }
}

TEST_CASE("forces and energies of regions and solvers are those of the law") {
  const OneTetrahedron one;
  const Elements elements(one.setup);
  const Mat34<double> f =
      corner_forces<double>(one.s.volume * law_stress(one.law, one.H), one.s.gradients.rightCols<3>());
  const double energy = one.s.volume * law_energy_density(one.law, one.H);
  CHECK(difference(forces<double>(one.setup, one.u), f) < 1e-13);
  CHECK(difference(forces<float>(one.setup, one.u.cast<float>()).cast<double>(), f) < 1e-5);
  CHECK(elastic_energy(one.setup, one.u) == near(energy, 1e-13));
  const EnergyAndForces exact = energy_and_forces(elements, one.u);
  CHECK(difference(exact.forces, f) < 1e-13);
  CHECK(exact.energy == near(energy, 1e-13));
  const Mat3<double> F = Mat3<double>::Identity() + one.H;
  CHECK(difference(tet_fields(elements, 0, one.u, one.law.pressure).stress,
                   law_stress(one.law, one.H) * F.transpose() / F.determinant()) < 1e-13);
}

// Beside the law at given pressures, four nodes with (Fα)⊗(Fα) wλ/V_n (V/4)² each, V_n = V/4.
TEST_CASE("stiffnesses of regions, solvers and the time step are those of the law") {
  const OneTetrahedron one;
  const Elements elements(one.setup);
  const Mat34<double> u = one.u;
  CHECK(difference(tet_stiffness(elements, 0, u, RegionModel::nonlinear, one.law.pressure),
                   one.s.volume * law_stiffness(one.law, one.H, one.s.gradients)) < 1e-14);
  Law<double> alone = one.law;  // a corner's stiffness knows no nodal pressure
  alone.pressure = 0;
  const CornerStiffness corners = corner_stiffness(elements, 0, u);
  RegionEdit edit;
  edit.entered = {0};
  edit.vertices = {0, 1, 2, 3};
  NonlinearRegion<double> region;
  region.follow(elements, edit);
  DiagonalStiffness K = DiagonalStiffness::Zero(6, 4);
  Parallel one_thread;
  region.add_diagonal_stiffness(one.u, K, one_thread);
  for (int c = 0; c < 4; ++c) {
    const Vec3d a = one.s.gradients.col(c), Fa = a + one.H * a;
    CHECK(difference(corners.col(c), upper(one.s.volume * law_diagonal_block(alone, one.H, a))) < 1e-14);
    const double nodal_lambda = one.setup.materials[0].nodal_lambda();
    const Mat3<double> of_nodes = nodal_lambda * Fa * Fa.transpose();
    CHECK(difference(K.col(c), upper(one.s.volume * (law_diagonal_block(one.law, one.H, a) + of_nodes))) <
          1e-13);
  }
}

TEST_CASE("the defects of a linear region are those of Hooke's law against the law") {
  const OneTetrahedron one;
  const Elements elements(one.setup);
  const Zones zones(elements, 1);
  const Mat3<double> D = one.s.volume * (law_stress(one.law, one.H) -
                                         hooke_stress(one.H, seed_material.lambda, seed_material.mu));
  CHECK(difference(exact_defects(elements, zones, one.u), D.reshaped()) < 1e-13);
  const MeanDefects mean(elements, zones);
  CHECK(difference(mean.at(0, mean.gradient(0, one.u), false), D.reshaped()) < 1e-12);
}

TEST_CASE("an inverted tetrahedron without a guard has finite forces and stiffness") {
  OneTetrahedron one;
  one.setup.guard_below = 0;
  const Elements elements(one.setup);
  Mat34<double> u = one.setup.mesh.points;
  u *= -1.5;
  const EnergyAndForces inverted = energy_and_forces(elements, u);
  CHECK(inverted.smallest_volume_ratio == near(-0.125, 1e-12));
  CHECK(difference(forces<double>(one.setup, u), inverted.forces) < 1e-13);
  CHECK(tet_stiffness(elements, 0, u).allFinite());
}
