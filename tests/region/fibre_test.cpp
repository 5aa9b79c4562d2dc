// Fibres and the neo-Hookean law in all that evaluates tetrahedra.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <numeric>
#include <random>

#include "fibre_support.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/fem/transverse_isotropy.h"
#include "lobe/linearity/defect.h"
#include "lobe/region/nonlinear.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"
#include "lobe/solve/tangent.h"
#include "lobe/time/vertex_frequencies.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Fibres in some tetrahedra, SVK or neo-Hookean without fibres in the others, in all three models.
Setup fibrous_parts_setup(const TetMesh& mesh) {
  Setup setup = fibrous_setup(mesh);
  setup.materials.push_back({7e4, 2e4, 1100});
  setup.materials.push_back({4e4, 1e4, 1000, 0, MaterialLaw::neo_hookean});
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const double x = barycentre(mesh, t).x();
    setup.material_of[std::size_t(t)] = t % 3 == 0 ? (t % 2 == 0 ? 1 : 2) : 0;
    setup.region_of[std::size_t(t)] = x < 0.01   ? RegionModel::precomputed
                                      : x < 0.02 ? RegionModel::tensor_mass
                                                 : RegionModel::nonlinear;
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -9.81};
  return setup;
}

Mat3X<double> state_of(const TetMesh& mesh) { return random_displacement(mesh.vertex_count(), 1e-3); }

double relative_gap(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).norm() / b.norm(); }

std::vector<Setup> variants() {
  const TetMesh mesh = irregular_box(2);
  std::vector<Setup> all{fibrous_setup(mesh),       fibrous_setup(mesh, RegionModel::tensor_mass),
                         neo_hookean_setup(mesh),   yeoh_setup(mesh),
                         mooney_rivlin_setup(mesh), holzapfel_setup(mesh)};
  for (std::size_t i : {0, 2, 5}) {
    all.push_back(all[i]);
    all.back().volume_penalty = 1e5;
    all.back().guard_below = 0.9;
  }
  return all;
}

}  // namespace

TEST_CASE("forces with fibres and of neo-Hookean bodies are minus the slope of the energy") {
  for (const Setup& setup : variants())
    check_that_forces_are_minus_the_slope_of_the_energy(setup, state_of(setup.mesh));
}

TEST_CASE("the solvers' forces and tangent are those of the regions") {
  for (const Setup& setup : variants()) {
    const Elements elements(setup);
    const Mat3X<double> u = state_of(setup.mesh), w = random_displacement(u.cols(), 1, 3);
    CHECK(relative_gap(forces<double>(setup, u), energy_and_forces(elements, u).forces) < 1e-11);
    CHECK(relative_gap(forces<float>(setup, u.cast<float>()).cast<double>(),
                       energy_and_forces(elements, u).forces) < 1e-4);
    Mat3X<double> product = Mat3X<double>::Zero(3, u.cols());
    for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
      const Eigen::Vector4i corners = setup.mesh.tets.col(t);
      const Mat34<double> at_corners = u(Eigen::all, corners), by = w(Eigen::all, corners);
      product(Eigen::all, corners) += (tet_stiffness(elements, t, at_corners) * by.reshaped()).reshaped(3, 4);
    }
    const double h = 1e-8;
    const Mat3X<double> slope =
        (energy_and_forces(elements, u - h * w).forces - energy_and_forces(elements, u + h * w).forces) /
        (2 * h);
    CHECK(relative_gap(product, slope) < 1e-6);
  }
}

TEST_CASE("what a vertex feels when it moves alone is the diagonal of the tangent") {
  for (const Setup& setup : variants()) {
    if (setup.region_of[0] != RegionModel::nonlinear) continue;
    const Elements elements(setup);
    const Mat3X<double> u = state_of(setup.mesh);
    RegionEdit edit;
    edit.entered.resize(std::size_t(setup.mesh.tet_count()));
    std::iota(edit.entered.begin(), edit.entered.end(), 0);
    NonlinearRegion<double> region;
    region.follow(elements, edit);
    DiagonalStiffness K = DiagonalStiffness::Zero(6, u.cols()), expected = K;
    Parallel one_thread;
    region.add_diagonal_stiffness(u, K, one_thread);
    for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
      const Mat34<double> at_corners = u(Eigen::all, setup.mesh.tets.col(t));
      const TetStiffness full = tet_stiffness(elements, t, at_corners);
      for (int c = 0; c < 4; ++c) {
        const Mat3<double> block = full.block<3, 3>(3 * c, 3 * c);
        expected.col(setup.mesh.tets(c, t)) += Eigen::Vector<double, 6>(
            block(0, 0), block(0, 1), block(0, 2), block(1, 1), block(1, 2), block(2, 2));
      }
    }
    CHECK(relative_gap(K, expected) < 1e-12);
  }
}

TEST_CASE("patch test with fibres: an affine map gives no force inside") {
  const TetMesh mesh = irregular_box(4);
  const Topology topology(mesh);
  std::vector<bool> inner(std::size_t(mesh.vertex_count()), true);
  for (Index code : topology.boundary_faces())
    for (Index v : topology.face(code)) inner[std::size_t(v)] = false;
  CHECK(std::count(inner.begin(), inner.end(), true) > 0);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> u = affine_displacement(mesh.points, F);
  for (Setup setup :
       {fibrous_setup(mesh), fibrous_setup(mesh, RegionModel::tensor_mass), neo_hookean_setup(mesh),
        yeoh_setup(mesh), mooney_rivlin_setup(mesh), holzapfel_setup(mesh)}) {
    if (setup.mesh.fibres.cols() > 0) setup.mesh.fibres.colwise() = Vec3d(2, -1, 0.5).normalized();
    const Mat3X<double> f = forces<double>(setup, u);
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (inner[std::size_t(v)]) CHECK(f.col(v).norm() < 1e-12 * f.colwise().norm().maxCoeff());
  }
}

TEST_CASE("mesh, fibres and displacements turned together turn the forces, and nothing else") {
  const Mat3<double> Q = Eigen::AngleAxisd(2.1, Vec3d(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const Setup& setup : variants()) {
    Setup turned = setup;
    turned.mesh.points = Q * setup.mesh.points;
    turned.mesh.fibres = Q * setup.mesh.fibres;
    for (Elastic& elastic : turned.materials)
      Eigen::Map<Vec3d>(elastic.fibre_plane.data()) = Q * Vec3d(elastic.fibre_plane.data());
    const Mat3X<double> u = state_of(setup.mesh);
    CHECK(relative_gap(forces<double>(turned, Q * u), Q * forces<double>(setup, u)) < 1e-10);
    if (setup.mesh.fibres.cols() == 0) continue;
    turned.mesh.fibres = setup.mesh.fibres;  // fibres that stay behind are felt
    CHECK(relative_gap(forces<double>(turned, Q * u), Q * forces<double>(setup, u)) > 1e-2);
  }
}

TEST_CASE("another numbering of vertices, tetrahedra and corners leaves fibres and forces where they are") {
  const Setup setup = fibrous_setup(irregular_box(5));
  const Index n = setup.mesh.vertex_count(), tets = setup.mesh.tet_count();
  Setup other = setup;
  for (Index v = 0; v < n; ++v) other.mesh.points.col(v) = setup.mesh.points.col(n - 1 - v);
  for (Index t = 0; t < tets; ++t) {
    const Eigen::Vector4i c = setup.mesh.tets.col(tets - 1 - t);
    other.mesh.tets.col(t) << n - 1 - c[1], n - 1 - c[2], n - 1 - c[0], n - 1 - c[3];
    other.mesh.fibres.col(t) = setup.mesh.fibres.col(tets - 1 - t);
  }
  const Mat3X<double> u = state_of(setup.mesh);
  CHECK(relative_gap(forces<double>(other, u.rowwise().reverse()).rowwise().reverse(),
                     forces<double>(setup, u)) < 1e-12);
}

TEST_CASE("equal constants are the isotropic body to rounding, whatever the fibres") {
  Setup setup = fibrous_setup(irregular_box(3));
  set_transverse({3e4, 3e4, 0.4, 0.4, 3e4 / 2.8}, setup.materials[0]);
  setup.materials[0].fibre.stretch += 1e-9;  // so that there are fibres at all
  Setup isotropic = setup_of(setup.mesh);
  isotropic.materials[0].lambda = 3e4 * 0.4 / (1.4 * 0.2);
  isotropic.materials[0].mu = 3e4 / 2.8;
  const Mat3X<double> u = state_of(setup.mesh);
  CHECK(relative_gap(forces<double>(setup, u), forces<double>(isotropic, u)) < 1e-13);
}

TEST_CASE("cuts of all regions with fibres leave what would be built afresh") {
  World<double> world(fibrous_parts_setup(irregular_box(3)));
  State<double> state = world.state();
  CompactMesh compacted;
  state.u += state_of(world.current_setup(compacted).mesh);
  world.set_state(state);
  std::vector<Index> order(std::size_t(world.elements().topology.tet_count()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  for (std::size_t i = 0; i < order.size(); i += 9) {
    world.remove_tets({order.begin() + long(i), order.begin() + long(std::min(order.size(), i + 9))});
    CHECK(compare_with_rebuilt(world).largest() < 1e-9);
  }
}

TEST_CASE("a bar with fibres stretches along and across as its closed form, for small and large strains") {
  const double length = 0.03;
  const double nu_TL = muscle.poisson_along * muscle.young_across / muscle.young_along;
  struct Case {
    Vec3d fibre;
    double E, nu_y, nu_z;
  };
  for (const Case& c : {Case{Vec3d::UnitX(), muscle.young_along, muscle.poisson_along, muscle.poisson_along},
                        Case{Vec3d::UnitZ(), muscle.young_across, muscle.poisson_across, nu_TL}})
    for (double stretch : {0.8, 0.999, 1.3}) {
      Setup setup = fibrous_setup(box_mesh(Vec3d::Constant(length), 2, 2, 2));
      setup.mesh.fibres.colwise() = c.fibre;
      for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
        for (int axis = 0; axis < 3; ++axis) {
          const double X = setup.mesh.points(axis, v);
          Axes only{};
          only[std::size_t(axis)] = true;
          if (X == 0) setup.prescribed.push_back({v, Vec3d::Zero(), only});
          if (axis == 0 && X > length - 1e-9)
            setup.prescribed.push_back({v, {(stretch - 1) * length, 0, 0}, only});
        }
      const StaticResult result = solve_static(setup);
      REQUIRE(result.converged);
      const double square = stretch * stretch - 1;
      const Mat3<double> F =
          Vec3d(stretch, std::sqrt(1 - c.nu_y * square), std::sqrt(1 - c.nu_z * square)).asDiagonal();
      CHECK(relative_gap(result.u, affine_displacement(setup.mesh.points, F)) < 1e-7);
      double force = 0;
      const Mat3X<double> f = energy_and_forces(Elements(setup), result.u).forces;
      for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
        if (setup.mesh.points(0, v) == 0) force += f(0, v);
      CHECK(force == near(c.E * stretch * square / 2 * length * length, 1e-7));
    }
}

TEST_CASE("the defect of a zone with fibres is that of its law against its linear one") {
  const Setup setup = fibrous_setup(irregular_box(2));
  const Elements elements(setup);
  const Mat3X<double> u = state_of(setup.mesh);
  Mat3<double> expected = Mat3<double>::Zero();
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Shape s = elements.shape_of(t);
    const Mat34<double> at_corners = u(Eigen::all, setup.mesh.tets.col(t));
    const Mat3<double> H = displacement_gradient<double>(at_corners, s.gradients.rightCols<3>());
    expected +=
        s.volume * (law_stress(nonlinear_law(elements, t), H) - linear_stress(linear_law(elements, t), H));
  }
  CHECK(relative_gap(exact_defects(elements, Zones(elements, 1), u).rowwise().sum(), expected.reshaped()) <
        1e-12);
}

TEST_CASE(
    "a world without a direction where its material has fibres is refused, and so is what cannot go on") {
  const TetMesh mesh = irregular_box(2);
  Setup setup = fibrous_setup(mesh);
  setup.mesh.fibres.resize(3, 0);
  CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("its direction is missing"), InputError);
  setup = fibrous_setup(mesh);
  setup.mesh.fibres(1, 7) = std::nan("");
  CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("tetrahedron 7"), InputError);
  for (const double length : {0.0, 0.99, 1.01}) {
    setup = fibrous_setup(mesh);
    setup.mesh.fibres.col(7) *= length;
    CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("tetrahedron 7"), InputError);
    CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("no unit vector"), InputError);
  }
  setup = fibrous_setup(mesh);
  setup.mesh.fibres.col(7) *= 1 + 1e-9;  // as a file rounds it
  CHECK_NOTHROW(World<double>{setup});
  for (const Index count : {mesh.tet_count() - 1, mesh.tet_count() + 1}) {
    setup = fibrous_setup(mesh);
    setup.mesh.fibres.conservativeResize(3, count);
    setup.mesh.fibres.col(count - 1) = Vec3d::UnitX();
    CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("one column per tetrahedron"), InputError);
  }
  setup = holzapfel_setup(mesh);
  setup.mesh.fibres.col(7) = Vec3d(setup.materials[0].fibre_plane.data()).normalized();
  CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("tetrahedron 7 has its direction along"),
                       InputError);
  setup.materials[0].fibre_angle = 0;  // one family: no plane is read
  CHECK_NOTHROW(World<double>{setup});
  setup = fibrous_setup(mesh);
  setup.materials[0].fibre.stretch = -1e6;
  CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains("not positive definite"), InputError);
}

TEST_CASE("a world with fibres goes on with the same bits from a checkpoint") {
  const Setup setup = fibrous_parts_setup(irregular_box(3));
  World<double> world = world_at(setup, state_of(setup.mesh));
  REQUIRE(world.advance(0.01).ok);
  World<double> other(setup);
  other.restore(world.save());
  REQUIRE(world.advance(0.01).ok);
  REQUIRE(other.advance(0.01).ok);
  CHECK(world.state().u == other.state().u);
  CHECK(world.state().v == other.state().v);
}

TEST_CASE("with fibres implicit steps and selective masses come to rest at the equilibrium") {
  Setup setup = fibrous_setup(irregular_box(3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 1e-9) setup.prescribed.push_back({v});
  setup.gravity = {0, 3, -9.81};
  setup.damping = 60;
  const Mat3X<double> rest = solve_static(setup).u;
  const auto distance_at_rest = [&](const Setup& one) {
    World<double> world(one);
    REQUIRE(world.advance(1.5).ok);
    return relative_gap(world.state().u, rest);
  };
  Setup implicit = setup, selective = setup;
  implicit.integrator = Integrator::generalised_alpha;
  implicit.implicit_step = 5e-3;
  CHECK(distance_at_rest(implicit) < 1e-6);
  selective.selective_mass = 2;
  CHECK(distance_at_rest(selective) < 1e-6);
}
