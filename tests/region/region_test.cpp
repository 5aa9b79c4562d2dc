#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <limits>
#include <numeric>

#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

bool on_boundary(const Topology& topology, Index v) {
  for (Index code : topology.boundary_faces())
    if ((topology.face(code).array() == v).any()) return true;
  return false;
}

}  // namespace

TEST_CASE("patch test: an affine map gives no force inside and the exact energy") {
  const TetMesh mesh = irregular_box(4);
  const Topology topology(mesh);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  const Mat3X<double> u = affine_displacement(mesh.points, F);
  for (RegionModel model : {RegionModel::nonlinear, RegionModel::tensor_mass}) {
    const Mat3X<double> f = forces<double>(setup_of(mesh, model), u);
    int inner = 0;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      if (on_boundary(topology, v)) continue;
      ++inner;
      CHECK(f.col(v).norm() < 1e-12 * f.colwise().norm().maxCoeff());
    }
    CHECK(inner > 0);
  }
  const double exact =
      total_volume(mesh) * svk_energy_density<double>(F - Mat3<double>::Identity(), 4e4, 1e4);
  CHECK(elastic_energy(setup_of(mesh), u) == near(exact, 1e-12));
}

TEST_CASE("a rigid motion gives no SVK force; a translation gives none to the last bit") {
  const TetMesh mesh = irregular_box();
  const Mat3<double> R = Eigen::AngleAxisd(2.0, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  Mat3X<double> u = affine_displacement(mesh.points, R);
  const double scale = 1e4 * 0.01 * 0.01;  // μ × area of a face
  CHECK(forces<double>(setup_of(mesh), u).norm() < 1e-12 * scale);
  u = Vec3d(0.25, -0.5, 0.125).replicate(1, mesh.vertex_count());
  CHECK(forces<double>(setup_of(mesh), u).norm() == 0);
  CHECK(forces<double>(setup_of(mesh, RegionModel::tensor_mass), u).norm() == 0);
}

TEST_CASE_TEMPLATE("the forces add up to nothing, also of a body that has turned far", Real, float, double) {
  const TetMesh mesh = irregular_box();
  const Mat3<double> R = Eigen::AngleAxisd(2.0, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  const Mat3X<Real> u =
      (affine_displacement(mesh.points, R) + random_displacement<double>(mesh.vertex_count(), 1e-5))
          .template cast<Real>();
  const Mat3X<double> f = forces<Real>(setup_of(mesh), u).template cast<double>();
  CHECK(f.rowwise().sum().norm() < std::numeric_limits<Real>::epsilon() * f.colwise().norm().sum());
}

TEST_CASE("forces in single precision are those in double precision, also of a body that has turned far") {
  const TetMesh mesh = irregular_box(4);  // edges of 0.01
  const Mat3<double> R = Eigen::AngleAxisd(2.5, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  const Mat3X<double> x = R * (mesh.points + random_displacement(mesh.vertex_count(), 5e-4));
  const Mat3X<double> u = (x - mesh.points).colwise() + Vec3d(0.3, -0.2, 0.1);
  const Mat3X<float> single = u.cast<float>();
  const Mat3X<float> direct = forces<float>(setup_of(mesh), single);
  const Mat3X<double> exact = forces<double>(setup_of(mesh), single.cast<double>());
  CHECK((direct.cast<double>() - exact).norm() < 1e-4 * exact.norm());
  const Mat3X<double> moved = random_displacement(mesh.vertex_count(), 2e-3);
  for (const Setup& setup : {setup_of(mesh), hybrid_setup(mesh)}) {
    const Mat3X<double> f = forces<double>(setup, moved);
    CHECK((forces<float>(setup, moved.cast<float>()).cast<double>() - f).norm() < 1e-6 * f.norm());
  }
}

TEST_CASE("forces are minus the slope of the energy in every region and at the interface") {
  const TetMesh mesh = irregular_box(2);
  check_that_forces_are_minus_the_slope_of_the_energy(hybrid_setup(mesh),
                                                      random_displacement(mesh.vertex_count(), 2e-3));
}

TEST_CASE("action equals reaction: no net force in a hybrid, no net moment in the non-linear region") {
  const TetMesh mesh = irregular_box(4);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3);
  const Mat3X<double> hybrid = forces<double>(hybrid_setup(mesh), u);
  CHECK(hybrid.rowwise().sum().norm() < 1e-13 * hybrid.norm());
  Setup setup = setup_of(mesh);
  setup.volume_penalty = 1e5;
  const Mat3X<double> f = forces<double>(setup, u);
  Vec3d moment = Vec3d::Zero();
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    moment += Vec3d(mesh.points.col(v) + u.col(v)).cross(Vec3d(f.col(v)));
  CHECK(moment.norm() < 1e-12 * f.norm() * 0.04);
}

TEST_CASE("forces do not depend on the numbering of vertices, tetrahedra or corners") {
  const TetMesh mesh = irregular_box();
  const Setup setup = hybrid_setup(mesh);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3);
  std::mt19937 random(3);
  std::vector<Index> vertex(mesh.vertex_count()), tet(mesh.tet_count());
  std::iota(vertex.begin(), vertex.end(), 0);
  std::iota(tet.begin(), tet.end(), 0);
  std::shuffle(vertex.begin(), vertex.end(), random);
  std::shuffle(tet.begin(), tet.end(), random);
  Setup shuffled = setup;
  Mat3X<double> moved(3, u.cols());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    shuffled.mesh.points.col(vertex[v]) = mesh.points.col(v);
    moved.col(vertex[v]) = u.col(v);
  }
  constexpr int even[3][4] = {
      {1, 2, 0, 3}, {1, 0, 3, 2}, {3, 1, 0, 2}};  // even permutations keep the orientation
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (int c = 0; c < 4; ++c) shuffled.mesh.tets(c, tet[t]) = vertex[mesh.tets(even[t % 3][c], t)];
    shuffled.region_of[tet[t]] = setup.region_of[t];
    shuffled.material_of[tet[t]] = setup.material_of[t];
  }
  const Mat3X<double> f = forces<double>(setup, u), g = forces<double>(shuffled, moved);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    CHECK((f.col(v) - g.col(vertex[v])).norm() < 1e-13 * f.norm());
}

TEST_CASE("one and two threads give the same bits") {
  const TetMesh mesh = irregular_box(14);  // 16,464 tetrahedra: more than one range of work
  const Setup setup = hybrid_setup(mesh);
  const Mat3X<float> u = random_displacement<float>(mesh.vertex_count(), 2e-3);
  CHECK(forces<float>(setup, u, 1) == forces<float>(setup, u, 2));
}

TEST_CASE("moving tetrahedra between regions gives the model built with these regions") {
  const TetMesh mesh = irregular_box();
  Setup setup = setup_of(mesh, RegionModel::tensor_mass);
  World<double> world(setup);
  std::vector<Index> moved;
  for (Index t = 0; t < mesh.tet_count(); t += 2) moved.push_back(t);
  world.apply(SetRegion{moved, RegionModel::nonlinear});
  for (Index t : moved) setup.region_of[t] = RegionModel::nonlinear;
  State<double> state = world.state();
  state.u = random_displacement(mesh.vertex_count(), 2e-3);
  world.set_state(state);
  const Mat3X<double> fresh = forces<double>(setup, state.u);
  CHECK((world.forces() - fresh).norm() < 1e-13 * fresh.norm());
}
