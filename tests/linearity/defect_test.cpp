#include "lobe/linearity/defect.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "doubled.h"
#include "fibre_support.h"
#include "lobe/condense/linearisation.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/fem/svk.h"
#include "lobe/linearity/influence.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const Vec3d axis = Vec3d(1, -2, 0.5).normalized();

Mat3<double> skew(const Vec3d& w) {
  Mat3<double> W;
  W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return W;
}

Mat3<double> some_strain(double size) {
  Mat3<double> e;
  e << 0.5, 0.2, -0.3, 0.2, -0.4, 0.1, -0.3, 0.1, 0.6;
  return size * e;
}

Setup body_of(const TetMesh& mesh) {
  Setup setup = setup_of(mesh);
  setup.volume_penalty = 1e5;
  return setup;
}

Mat3<double> defect_at(const Mat3<double>& H) {
  return stress_defect(nonlinear_law(seed_material, 1e5, 0), linear_law(seed_material), H);
}

// Σ f ⊗ X of forces on the vertices: −∫P dV, whatever the tetrahedra's stresses are.
Eigen::Matrix<double, 9, 1> moments(const Mat3X<double>& f, const Setup& setup) {
  const Mat3<double> moments = f * setup.mesh.points.transpose();
  return moments.reshaped();
}

// Of all forces of the body if it is linear and if it is not.
Eigen::Matrix<double, 9, 1> direct_defect(const Setup& nonlinear, const Mat3X<double>& u) {
  Setup linear = nonlinear;
  linear.region_of.assign(linear.region_of.size(), RegionModel::tensor_mass);
  return moments(forces<double>(linear, u) - forces<double>(nonlinear, u), nonlinear);
}

// Without the terms, with the guard, with nodal pressure of a share of two materials, with both; of plain
// tetrahedra, and of edge-smoothed ones in the first material.
std::vector<Setup> setups_of_all_terms() {
  std::vector<Setup> setups;
  for (ElementType element : {ElementType::tetrahedron, ElementType::edge_smoothed})
    for (double below : {0.0, 0.7})
      for (double share : {0.0, 0.8}) {
        Setup setup = hybrid_setup(irregular_box(4));
        setup.region_of.assign(setup.region_of.size(), RegionModel::nonlinear);
        setup = averaged(setup, share);
        setup.materials[0].element = element;
        setup.guard_below = below;
        setups.push_back(setup);
      }
  return setups;
}

}  // namespace

TEST_CASE("the non-linear state of a linear rotation is the rotation, free of strain") {
  for (const double angle : {0.0, 1e-9, 0.3, 1.5, 3.0}) {
    const Mat3<double> exact = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    CHECK((nonlinear_gradient(skew(angle * axis)) + Mat3<double>::Identity() - exact).norm() < 1e-14);
  }
}

TEST_CASE(
    "the Green strain of the non-linear state is the linear strain, as long as that leaves it a volume") {
  for (const double size : {1e-3, 0.1, 0.5}) {
    const Mat3<double> strain = some_strain(size);
    CHECK((green_strain<double>(nonlinear_gradient(strain + skew(0.7 * axis))) - strain).norm() < 1e-7);
  }
  const Mat3<double> crushed = -3 * Mat3<double>::Identity();
  CHECK((nonlinear_gradient(crushed) + 0.8 * Mat3<double>::Identity()).norm() < 1e-12);
}

TEST_CASE("the stress defect is of second order in the displacement gradient") {
  const Mat3<double> H = some_strain(1) + skew(axis);
  const auto size = [&](double h) { return defect_at(h * H).norm(); };
  CHECK(size(1e-3) > 0);
  CHECK(std::log2(size(2e-4) / size(1e-4)) == near(2, 0.01));
}

TEST_CASE("mean defects are the exact ones where the gradient is the same everywhere") {
  const Elements elements(body_of(box_mesh({0.02, 0.03, 0.04}, 3, 3, 4)));
  const Zones zones(elements, 5);
  const Mat3<double> H = some_strain(0.2) + skew(0.3 * axis);
  const Mat3X<double> u = H * elements.points.view();
  const Defects exact = exact_defects(elements, zones, u);
  const MeanDefects mean(elements, zones);
  for (Index z = 0; z < zones.count(); ++z) {
    const auto gradient = mean.gradient(z, u);
    CHECK((gradient - H.reshaped()).norm() < 1e-12);
    CHECK((mean.at(z, gradient, false) - exact.col(z)).norm() < 1e-10 * exact.col(z).norm());
    const Mat3<double> of_nonlinear = defect_at(nonlinear_gradient(H)) * zones.volume[std::size_t(z)];
    CHECK((mean.at(z, gradient, true) - of_nonlinear.reshaped()).norm() < 1e-10 * of_nonlinear.norm());
  }
}

TEST_CASE("exact defects are what the forces of the linear and of the non-linear body differ by") {
  for (const Setup& setup : setups_of_all_terms()) {
    CAPTURE(setup.guard_below);
    CAPTURE(setup.materials[0].nodal_pressure);
    const Elements elements(setup);
    const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 1e-3);
    CHECK(energy_and_forces(elements, u).smallest_volume_ratio < 0.65);
    const auto direct = direct_defect(setup, u);
    for (Index count : {1, 7}) {
      const Defects defects = exact_defects(elements, Zones(elements, count), u);
      CHECK((defects.rowwise().sum() - direct).norm() < 1e-11 * direct.norm());
    }
  }
}

TEST_CASE("mean defects of an even deformation are what the forces of both bodies differ by") {
  for (Setup setup : setups_of_all_terms()) {
    CAPTURE(setup.guard_below);
    CAPTURE(setup.materials[0].nodal_pressure);
    setup.material_of.assign(setup.material_of.size(), 0);
    const Elements elements(setup);
    const Zones zones(elements, 1);
    const Mat3<double> H = some_strain(0.1) + skew(0.3 * axis) - 0.3 * Mat3<double>::Identity();
    const Mat3X<double> u = H * setup.mesh.points;
    CHECK(energy_and_forces(elements, u).smallest_volume_ratio < 0.6);
    const auto direct = direct_defect(setup, u);
    const MeanDefects mean(elements, zones);
    CHECK((mean.at(0, mean.gradient(0, u), false) - direct).norm() < 1e-11 * direct.norm());
  }
}

TEST_CASE("mean defects of an even deformation of parallel fibres are what forces differ by") {
  for (const Vec3d& a : {Vec3d(1, 0, 0), Vec3d(1, -2, 0.5)}) {
    Setup setup = fibrous_setup(irregular_box(4));
    for (Index t = 0; t < setup.mesh.tet_count(); ++t)  // to and fro: the same fibre
      setup.mesh.fibres.col(t) = (t % 2 ? 1 : -1) * a.normalized();
    const Elements elements(setup);
    const Mat3<double> H = some_strain(0.1) + skew(0.3 * axis);
    const Mat3X<double> u = H * setup.mesh.points;
    const auto direct = direct_defect(setup, u);
    const MeanDefects mean(elements, Zones(elements, 1));
    CHECK((mean.at(0, mean.gradient(0, u), false) - direct).norm() < 1e-11 * direct.norm());
    setup.mesh.fibres.colwise() = a.unitOrthogonal();
    CHECK((direct_defect(setup, u) - direct).norm() > 0.1 * direct.norm());
  }
}

TEST_CASE("mean defects beyond the tangent are what forces differ by from those linearised there") {
  for (double below : {0.0, 0.7}) {
    CAPTURE(below);
    Setup setup = body_of(irregular_box(3));
    setup.guard_below = below;
    const Elements elements(setup);
    const Zones zones(elements, 1);
    const Mat3<double> start = some_strain(0.1) - 0.25 * Mat3<double>::Identity(),
                       end = start + skew(0.1 * axis) + some_strain(0.05);
    const Mat3X<double> about = start * setup.mesh.points, u = end * setup.mesh.points;
    CHECK(energy_and_forces(elements, u).smallest_volume_ratio < 0.6);
    const Linearisation linearised{about};
    Mat3X<double> f = Mat3X<double>::Zero(3, setup.mesh.vertex_count());
    for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
      const Eigen::Vector4i corners = elements.topology.corners(t);
      const Linearisation::Forces linear = linearised.forces(elements, t, corners);
      const Mat34<double> at_corners = u(Eigen::all, corners);
      const Eigen::Matrix<double, 12, 1> force = linear.constant - linear.K * at_corners.reshaped();
      f(Eigen::all, corners) += force.reshaped(3, 4);
    }
    const Eigen::Matrix<double, 9, 1> direct = moments(f - forces<double>(setup, u), setup);
    const MeanDefects mean(elements, zones);
    const auto found = mean.beyond_tangent(0, mean.gradient(0, u), mean.gradient(0, about), false);
    CHECK((found - direct).norm() < 1e-6 * direct.norm());
  }
}

TEST_CASE("means that are found anew after a cut are those of the cut body") {
  Elements elements(body_of(box_mesh({0.02, 0.03, 0.04}, 3, 3, 4)));
  const Zones zones(elements, 5);
  MeanDefects mean(elements, zones);
  const MeshEdit edit =
      elements.topology.remove(std::vector<Index>(zones.tets[2].begin(), zones.tets[2].begin() + 7));
  elements.follow(edit);
  const Mat3X<double> u = Mat3X<double>::Random(3, elements.topology.vertex_count());
  const MeanDefects cut(elements, zones);
  const auto expected = cut.gradient(2, u);
  CHECK((mean.gradient(2, u) - expected).norm() > 0.1 * expected.norm());
  mean.find(elements, zones, 2);
  for (Index z = 0; z < zones.count(); ++z) {
    CHECK(mean.gradient(z, u) == cut.gradient(z, u));
    CHECK(mean.at(z, mean.gradient(z, u), true) == cut.at(z, cut.gradient(z, u), true));
  }
}

TEST_CASE("zones take every tetrahedron once, and are of about the same size") {
  const Elements elements(body_of(box_mesh({0.1, 0.1, 0.1}, 6, 6, 6)));
  const Zones zones(elements, 24);
  CHECK(zones.count() == 24);
  std::vector<int> taken(zones.of.size(), 0);
  double volume = 0;
  for (Index z = 0; z < zones.count(); ++z) {
    for (Index t : zones.tets[std::size_t(z)]) {
      ++taken[std::size_t(t)];
      CHECK(zones.of[std::size_t(t)] == z);
    }
    CHECK(zones.tets[std::size_t(z)].size() < 2 * zones.of.size() / 24);
    volume += zones.volume[std::size_t(z)];
  }
  CHECK(std::count(taken.begin(), taken.end(), 1) == std::ptrdiff_t(taken.size()));
  CHECK(volume == near(1e-3, 1e-12));
  CHECK_THROWS_WITH(Zones(elements, 0), doctest::Contains("must be 1 to the number of tetrahedra"));
}

TEST_CASE("a body of doubled tetrahedra that share their volume has the defects of the plain one") {
  for (const Setup& plain : {body_of(irregular_box(3)), fibrous_setup(irregular_box(3)),
                             averaged(hybrid_setup(irregular_box(3)))}) {
    const Elements one(plain), two(doubled(plain));
    const Zones zones(one, 5);
    Zones twice = zones;
    const auto count = static_cast<Index>(zones.of.size());
    twice.of.insert(twice.of.end(), zones.of.begin(), zones.of.end());
    for (std::vector<Index>& tets : twice.tets)
      for (std::size_t i = 0, n = tets.size(); i < n; ++i) tets.push_back(tets[i] + count);
    const Mat3X<double> u = random_displacement(plain.mesh.vertex_count(), 1e-3);
    const Defects exact = exact_defects(one, zones, u);
    CHECK((exact_defects(two, twice, u) - exact).norm() < 1e-12 * exact.norm());
    const MeanDefects means(one, zones), of_two(two, twice);
    for (Index z = 0; z < zones.count(); ++z) {
      double volume = 0;
      for (Index t : twice.tets[std::size_t(z)]) volume += two.volume(t);
      CHECK(volume == near(zones.volume[std::size_t(z)], 1e-12));
      const auto gradient = means.gradient(z, u);
      CHECK((of_two.gradient(z, u) - gradient).norm() < 1e-12 * gradient.norm());
      const auto about = (0.5 * gradient).eval();
      const double stress =
          (4e4 + 2e4) * gradient.norm() * volume;  // λ + 2μ: a defect is a small difference of it
      for (const bool is_linear : {false, true}) {
        const auto at = means.at(z, gradient, is_linear);
        CHECK((of_two.at(z, gradient, is_linear) - at).norm() < 1e-12 * at.norm());
        const auto beyond = means.beyond_tangent(z, gradient, about, is_linear);
        CHECK((of_two.beyond_tangent(z, gradient, about, is_linear) - beyond).norm() < 1e-12 * stress);
      }
    }
    HeldVertices held;
    for (Index v = 0; v < plain.mesh.vertex_count(); ++v)
      if (plain.mesh.points(0, v) < 1e-3)
        held.hold({v, HeldVertices::boundary, Vec3d::Zero(), Vec3d::Zero()});
    const Eigen::VectorXd error = Influence(one, zones, held, {}).displacement(exact);
    CHECK((Influence(two, twice, held, {}).displacement(exact) - error).norm() <
          1e-6 * error.norm());  // it is in single precision
  }
}
