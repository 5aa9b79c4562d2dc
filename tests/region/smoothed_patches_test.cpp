#include <doctest/doctest.h>

#include <numeric>
#include <random>

#include "lobe/error.h"
#include "lobe/region/corotational.h"
#include "lobe/region/nonlinear.h"
#include "lobe/sim/rebuild.h"
#include "near.h"
#include "smoothed_support.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class Region = NonlinearRegion<double>>
void check_diagonal_stiffness(const Setup& setup) {
  const TetMesh& mesh = setup.mesh;
  const Elements elements(setup);
  RegionEdit everything;
  everything.entered.resize(std::size_t(mesh.tet_count()));
  std::iota(everything.entered.begin(), everything.entered.end(), 0);
  Region region;
  region.follow(elements, everything);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 1e-3);
  DiagonalStiffness K = DiagonalStiffness::Zero(6, mesh.vertex_count());
  Parallel one_thread;
  const auto found = region.add_diagonal_stiffness(u, K, one_thread);
  CHECK(found.smallest_volume_ratio ==
        near(energy_and_forces(elements, u).smallest_volume_ratio, 1e-13));  // of single tetrahedra
  Tangent tangent(elements, Unknowns(mesh.vertex_count(), [](Index, int) { return true; }));
  tangent.update(u);
  const Eigen::MatrixXd exact = dense_stiffness(tangent, Index(3 * mesh.vertex_count()));
  const double scale = K.cwiseAbs().maxCoeff();
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Mat3<double> B = exact.block<3, 3>(3 * v, 3 * v);
    Eigen::Matrix<double, 6, 1> block;
    block << B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2);
    CHECK((K.col(v) - block).norm() < 1e-12 * scale);
  }
}

// Bodies of few or bad tetrahedra. Those that hang by an edge or a vertex share no domain.
std::vector<Setup> odd_bodies() {
  const auto of_tets = [](std::vector<Vec3d> points, std::vector<Eigen::Vector4i> tets) {
    TetMesh mesh;
    mesh.points.resize(3, Eigen::Index(points.size()));
    for (std::size_t v = 0; v < points.size(); ++v) mesh.points.col(Eigen::Index(v)) = 0.01 * points[v];
    mesh.tets.resize(4, Eigen::Index(tets.size()));
    for (std::size_t t = 0; t < tets.size(); ++t) mesh.tets.col(Eigen::Index(t)) = tets[t];
    mesh.labels.assign(tets.size(), 0);
    prepare(mesh, "odd");
    return setup_of(mesh);
  };
  const std::vector<Vec3d> four{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto with = [](std::vector<Vec3d> points, std::vector<Vec3d> more) {
    points.insert(points.end(), more.begin(), more.end());
    return points;
  };
  std::vector<Setup> bodies{
      of_tets(four, {{0, 1, 2, 3}}),
      of_tets(with(four, {{0, -1, 0}, {0, 0, -1}}), {{0, 1, 2, 3}, {0, 1, 4, 5}}),              // by an edge
      of_tets(with(four, {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}), {{0, 1, 2, 3}, {0, 4, 5, 6}}),  // a vertex
      of_tets({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.003}, {0.3, 0.3, 1}},              // a sliver
              {{0, 1, 2, 3}, {0, 1, 3, 4}, {1, 2, 3, 4}, {2, 0, 3, 4}}),
      setup_of(box_mesh({0.04, 0.04, 0.005}, 8, 8, 1)),  // one layer
      setup_of(irregular_box(3))};
  const auto set_poisson = [](Elastic& e, double nu) { e.lambda = 2 * e.mu * nu / (1 - 2 * nu); };
  set_poisson(bodies.back().materials[0], 0.4999);
  return bodies;
}

}  // namespace

TEST_CASE("a World's smoothed edges have the energy of static solutions, and a translation no force") {
  const TetMesh mesh = irregular_box(4);
  for (bool nodal_pressure : {false, true}) {
    const Setup setup = mixed_setup(mesh, nodal_pressure);
    const Mat3X<double> u = random_displacement(mesh.vertex_count(), 1e-3);
    CHECK(elastic_energy(setup, u) == near(energy_and_forces(Elements(setup), u).energy, 1e-13));
    const Mat3X<double> moved = Vec3d(0.25, -0.5, 0.125).replicate(1, mesh.vertex_count());
    CHECK(forces<double>(setup, moved).norm() == 0);
  }
}

TEST_CASE("with smoothed edges single precision follows double, and threads do not change a bit") {
  const TetMesh mesh = irregular_box(12);  // more than one range of work
  for (bool nodal_pressure : {false, true}) {
    const Setup setup = mixed_setup(mesh, nodal_pressure);
    const Mat3X<float> u = random_displacement<float>(mesh.vertex_count(), 1e-3);
    const Mat3X<double> exact = forces<double>(setup, u.cast<double>());
    const Mat3X<float> single = forces<float>(setup, u);
    CHECK((single.cast<double>() - exact).norm() < 1e-6 * exact.norm());
    CHECK(single == forces<float>(setup, u, 2));
    CHECK(exact == forces<double>(setup, u.cast<double>(), 2));
    const Mat3X<double> reference = energy_and_forces(Elements(setup), u.cast<double>()).forces;
    CHECK((exact - reference).norm() < 1e-12 * reference.norm());
  }
}

TEST_CASE("with smoothed edges the diagonal stiffness is that of the tangent") {
  for (bool nodal_pressure : {false, true})
    check_diagonal_stiffness(mixed_setup(irregular_box(2), nodal_pressure));
  check_diagonal_stiffness<CorotationalRegion<double>>(
      smoothed(setup_of(irregular_box(2), RegionModel::corotational)));
}

TEST_CASE_TEMPLATE("with smoothed edges every cut leaves the body that is built from the cut mesh", Real,
                   float, double) {
  const TetMesh mesh = irregular_box(6);
  const double tolerance = std::is_same_v<Real, float> ? 1e-5 : 1e-12;
  for (unsigned seed : {1u, 2u, 3u}) {
    World<Real> world =
        world_at<Real>(mixed_setup(mesh, seed > 1), random_displacement<Real>(mesh.vertex_count(), 1e-3));
    std::mt19937 random(seed);
    std::uniform_int_distribution<Index> any(0, mesh.tet_count() - 1);
    for (int cut = 0; cut < 12; ++cut) {
      std::vector<Index> tets;
      for (int i = 0; i < (cut % 3 == 2 ? 60 : 1 + cut); ++i) tets.push_back(any(random));
      world.remove_tets(tets);
      CHECK(compare_with_rebuilt(world).largest() < tolerance);
      CHECK(fault_of(world) == "");
    }
    std::vector<Index> rest(std::size_t(mesh.tet_count()));
    std::iota(rest.begin(), rest.end(), 0);
    world.remove_tets(rest);
    CHECK(world.forces().norm() == 0);
  }
}

TEST_CASE("an edge with more vertices around it than a patch takes is refused by name") {
  const int n = 300;  // a fan of tetrahedra around one edge
  Setup setup = setup_of(irregular_box(1));
  setup.mesh = TetMesh{};
  setup.mesh.points.resize(3, n + 2);
  setup.mesh.points.col(0) = Vec3d(0, 0, -1);
  setup.mesh.points.col(1) = Vec3d(0, 0, 1);
  setup.mesh.tets.resize(4, n);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979 * i / n;
    setup.mesh.points.col(i + 2) = Vec3d(std::cos(angle), std::sin(angle), 0);
    setup.mesh.tets.col(i) = Eigen::Vector4i(0, 1, 2 + i, 2 + (i + 1) % n);
  }
  setup.mesh.labels.assign(n, 0);
  setup.material_of.assign(n, 0);
  setup.region_of.assign(n, RegionModel::nonlinear);
  prepare(setup.mesh, "fan");
  CHECK(World<double>(setup).elements().topology.alive_count() == n);
  CHECK_THROWS_WITH_AS(World<double>(smoothed(setup)), doctest::Contains("its tetrahedra have 302 vertices"),
                       InputError);
}

TEST_CASE("few, flat, hanging or nearly incompressible smoothed tetrahedra move and stay finite") {
  for (bool nodal_pressure : {false, true})
    for (const Setup& plain : odd_bodies()) {
      CAPTURE(plain.mesh.tet_count());
      const Setup setup = smoothed(averaged(plain, nodal_pressure ? 1 : 0));
      World<double> world = world_at<double>(setup, random_displacement(setup.mesh.vertex_count(), 1e-5));
      CHECK(world.time_step_limit() > 0);
      CHECK(world.advance(200 * world.time_step_limit()).ok);
      CHECK(world.displacements().allFinite());
      CHECK(world.displacements().cwiseAbs().maxCoeff() < 1e-3);
      CHECK(compare_with_rebuilt(world).largest() < 1e-12);
    }
}
