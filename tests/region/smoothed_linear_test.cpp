// Edge-smoothed tetrahedra in regions that follow the linear law.
#include <doctest/doctest.h>

#include <numeric>
#include <random>

#include "lobe/region/tensor_mass.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"
#include "lobe/sort_unique.h"
#include "near.h"
#include "smoothed_support.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// The materials of mixed_setup(), with the half of the smaller y tensor-mass.
Setup half_tensor_mass(const TetMesh& mesh) {
  Setup setup = test::mixed_setup(mesh, false);
  const double middle = mesh.points.row(1).mean();
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (barycentre(mesh, t).y() < middle) setup.region_of[t] = RegionModel::tensor_mass;
  return setup;
}

RegionEdit all_entering(const TetMesh& mesh) {
  RegionEdit edit;
  edit.entered.resize(std::size_t(mesh.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  edit.vertices.resize(std::size_t(mesh.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  return edit;
}

}  // namespace

TEST_CASE("smoothed tensor-mass tetrahedra have the stiffness Σ V_e b⊗C b, and no force of a translation") {
  const TetMesh mesh = irregular_box(3);
  const Setup setup = half_tensor_mass(mesh);
  const Elements elements(setup);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 1e-3);
  const EnergyAndForces exact = energy_and_forces(elements, u);
  CHECK((forces<double>(setup, u) - exact.forces).norm() < 1e-13 * exact.forces.norm());
  CHECK(elastic_energy(setup, u) == near(exact.energy, 1e-13));
  CHECK((forces<float>(setup, u.cast<float>()).cast<double>() - exact.forces).norm() <
        1e-6 * exact.forces.norm());
  CHECK(exact.forces.rowwise().sum().norm() < 1e-13 * exact.forces.norm());
  const Mat3X<double> moved = Vec3d(0.25, -0.5, 0.125).replicate(1, mesh.vertex_count());
  CHECK(forces<double>(setup, moved).norm() == 0);
  Setup plain = setup;
  for (Elastic& elastic : plain.materials) elastic.element = ElementType::tetrahedron;
  CHECK(elastic_energy(setup, u) < 0.9 * elastic_energy(plain, u));
}

TEST_CASE("forces of smoothed linear tetrahedra are minus the slope of the energy, at interfaces, too") {
  const TetMesh mesh = irregular_box(2);
  check_that_forces_are_minus_the_slope_of_the_energy(half_tensor_mass(mesh),
                                                      random_displacement(mesh.vertex_count(), 1e-3));
}

TEST_CASE("the diagonal stiffness of smoothed tensor-mass tetrahedra is that of the tangent in any state") {
  const TetMesh mesh = irregular_box(3);
  Setup setup = half_tensor_mass(mesh);
  std::fill(setup.region_of.begin(), setup.region_of.end(), RegionModel::tensor_mass);
  const Elements elements(setup);
  TensorMassRegion<double> region;
  region.follow(elements, all_entering(mesh));
  DiagonalStiffness K = DiagonalStiffness::Zero(6, mesh.vertex_count());
  Parallel one_thread;
  region.add_diagonal_stiffness(random_displacement(mesh.vertex_count(), 1e-3), K, one_thread);
  Tangent tangent(elements, Unknowns(mesh.vertex_count(), [](Index, int) { return true; }));
  tangent.update(Mat3X<double>::Zero(3, mesh.vertex_count()));
  const Eigen::MatrixXd exact = dense_stiffness(tangent, Index(3 * mesh.vertex_count()));
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Mat3<double> B = exact.block<3, 3>(3 * v, 3 * v);
    Eigen::Matrix<double, 6, 1> block;
    block << B(0, 0), B(0, 1), B(0, 2), B(1, 1), B(1, 2), B(2, 2);
    CHECK((K.col(v) - block).norm() < 1e-12 * exact.norm());
  }
}

TEST_CASE("patch test across interfaces of regions, materials and elements: a small affine map stays") {
  const TetMesh mesh = irregular_box(6);
  Setup setup = smoothed(setup_of(mesh));
  setup.materials.push_back(seed_material);  // plain
  const RegionModel models[]{RegionModel::tensor_mass, RegionModel::precomputed, RegionModel::nonlinear};
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Vec3d x = barycentre(mesh, t);
    setup.region_of[t] = models[std::clamp(int(x.x() / 0.02), 0, 2)];
    setup.material_of[t] = x.y() > 0.04;
  }
  Mat3<double> G;  // so small that both laws agree to rounding
  G << 2, 3, -1, 0.5, -2, 2, -2, 1, 1;
  const Mat3X<double> exact = 1e-13 * G * mesh.points;
  const Topology topology(mesh);
  std::vector<bool> is_outside(std::size_t(mesh.vertex_count()), false);
  for (Index code : topology.boundary_faces())
    for (Index v : topology.face(code)) is_outside[std::size_t(v)] = true;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (is_outside[std::size_t(v)]) setup.prescribed.push_back({v, exact.col(v)});
  StaticOptions options;
  options.tolerance = 1e-13;
  const StaticResult found = solve_static(setup, options);
  REQUIRE(found.converged);
  CHECK((found.u - exact).norm() < 1e-12 * exact.norm());
  World<double> world(setup);  // with the middle condensed
  State<double> state = world.state();
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!world.body().regions.is_interior(v)) state.u.col(v) = exact.col(v);
  world.set_state(state);
  const double on_surface = found.reactions.colwise().norm().maxCoeff();
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!is_outside[std::size_t(v)]) CHECK(world.forces().col(v).norm() < 1e-12 * on_surface);
  CHECK((world.state().u - exact).norm() < 1e-12 * exact.norm());
}

TEST_CASE_TEMPLATE("after every cut smoothed linear tetrahedra are those that are built from the cut mesh",
                   Real, float, double) {
  const TetMesh mesh = irregular_box(6);
  const double tolerance = std::is_same_v<Real, float> ? 1e-5 : 1e-12;
  World<Real> world =
      world_at<Real>(half_tensor_mass(mesh), random_displacement<Real>(mesh.vertex_count(), 1e-3));
  std::mt19937 random(1);
  std::uniform_int_distribution<Index> any(0, mesh.tet_count() - 1);
  for (int cut = 0; cut < 12; ++cut) {
    std::vector<Index> tets;
    for (int i = 0; i < (cut % 3 == 2 ? 60 : 1 + cut); ++i) tets.push_back(any(random));
    world.remove_tets(tets);
    if (cut % 4 == 1) {  // regions exchange tetrahedra
      std::erase_if(tets, [](Index t) { return t % 2 == 0; });
      for (Index& t : tets) t = (t + 500) % mesh.tet_count();
      std::erase_if(tets, [&](Index t) { return !world.elements().topology.alive(t); });
      sort_unique(tets);
      world.apply(SetRegion{tets, cut == 5 ? RegionModel::nonlinear : RegionModel::tensor_mass});
    }
    CHECK(compare_with_rebuilt(world).largest() < tolerance);
    CHECK(fault_of(world) == "");
  }
  std::vector<Index> rest(std::size_t(mesh.tet_count()));
  std::iota(rest.begin(), rest.end(), 0);
  world.remove_tets(rest);
  CHECK(world.forces().norm() == 0);
}

TEST_CASE(
    "smoothed linear tetrahedra do not know threads, and keep their energy at nine tenths of the limit") {
  const TetMesh mesh = irregular_box(12);
  const Mat3X<float> u = random_displacement<float>(mesh.vertex_count(), 1e-3);
  CHECK(forces<float>(half_tensor_mass(mesh), u) == forces<float>(half_tensor_mass(mesh), u, 2));
  Setup setup = smoothed(setup_of(irregular_box(4), RegionModel::tensor_mass));
  setup.materials[0].fibre = {3e3, 8e3, 5e4};
  setup.mesh.fibres = Vec3d(1, 2, 2).normalized().replicate(1, setup.mesh.tet_count());
  World<double> world = world_at(setup, random_displacement(setup.mesh.vertex_count(), 1e-4));
  CHECK(energy_drift(world, 0.9 * world.time_step_limit(), 1000) < 1e-10);
}
