#include "lobe/solve/static_solver.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/select.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup reference_beam(RegionModel model) {
  const TetMesh mesh = read_mesh(LOBE_DATA_DIR "/reference_solutions/beam_coarse.msh").mesh;
  Setup setup = setup_of(mesh, model);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

void pull_end(Setup& setup, const Vec3d& traction) {
  const double end = setup.mesh.points.row(0).maxCoeff();
  for (const TetFace& face : outer_faces(setup.mesh)) {
    bool at_end = true;
    for (int c : face_corners[face.face])
      at_end = at_end && setup.mesh.points(0, setup.mesh.tets(c, face.tet)) > end - 1e-9;
    if (at_end) setup.face_loads.push_back({face.tet, face.face, traction});
  }
}

}  // namespace

TEST_CASE("the static solution is where the damped motion comes to rest, in a hybrid with the volume term") {
  Setup setup = reference_beam(RegionModel::nonlinear);
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (barycentre(setup.mesh, t).x() < 0.04) setup.region_of[t] = RegionModel::tensor_mass;
  setup.volume_penalty = 1e5;
  setup.gravity = {0, 0, -3};
  setup.damping = 25;
  const StaticResult result = solve_static(setup);
  REQUIRE(result.converged);
  World<double> world(setup);
  for (int i = 0; i < 150; ++i) REQUIRE(world.advance(1.0 / 30).ok);
  CHECK((world.state().u - result.u).norm() < 1e-8 * result.u.norm());
}

TEST_CASE("a body that can move freely is refused, and so is one held along a line") {
  Setup setup = setup_of(irregular_box(2));
  CHECK_THROWS_WITH_AS(solve_static(setup), doctest::Contains("is not held"), InputError);
  setup = setup_of(box_mesh({0.1, 0.02, 0.02}, 5, 1, 1));
  for (Index v = 0; v < 6; ++v) setup.prescribed.push_back({v, Vec3d::Zero()});  // an edge along x
  CHECK_THROWS_WITH_AS(solve_static(setup), doctest::Contains("do not lie on a line"), InputError);
}

TEST_CASE("a body of which everything is given has its equilibrium at once") {
  Setup setup = setup_of(irregular_box(2));
  const Vec3d moved(0.01, -0.02, 0.03);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.prescribed.push_back({v, moved});
  const StaticResult result = solve_static(setup);
  CHECK(result.converged);
  CHECK(result.unknowns == 0);
  CHECK(result.u == moved.replicate(1, setup.mesh.vertex_count()));
}

TEST_CASE("a load beyond double precision has no equilibrium") {
  Setup setup = reference_beam(RegionModel::nonlinear);
  setup.gravity = {0, 0, 1e308};
  const StaticResult result = solve_static(setup);
  CHECK_FALSE(result.converged);
  CHECK(result.reason.find("too large for double precision") != std::string::npos);
}

TEST_CASE("an edge that two bodies share is a hinge, a face is not") {
  // Two tetrahedra on either side of an edge of four that they do not share a face with.
  TetMesh mesh;
  mesh.points.resize(3, 6);
  mesh.points << 0, 0, 1, 1, -1, -1,  //
      0, 0, 0, 1, 0, -1,              //
      0, 1, 0, 0, 0, 0;
  mesh.tets.resize(4, 2);
  mesh.tets.col(0) << 0, 2, 3, 1;
  mesh.tets.col(1) << 0, 4, 5, 1;
  mesh.labels = {0, 0};
  Setup setup = setup_of(mesh);
  for (Index v : {0, 1, 2}) setup.prescribed.push_back({v, Vec3d::Zero()});
  setup.gravity = {0, 0, -1};
  CHECK_THROWS_WITH_AS(solve_static(setup), doctest::Contains("among them 1, is not held"), InputError);
  setup.prescribed.push_back({4, Vec3d::Zero(), {false, true, false}});  // stops the swing about the edge
  CHECK(solve_static(setup).converged);
}

TEST_CASE("rollers: uniaxial stretch with free sides has the closed form's force and lateral stretch") {
  const double length = 0.03;
  Setup setup = setup_of(box_mesh(Vec3d::Constant(length), 3, 3, 3));
  const double lambda = seed_material.lambda, mu = seed_material.mu;
  const double E = mu * (3 * lambda + 2 * mu) / (lambda + mu), nu = lambda / (2 * (lambda + mu));
  for (double stretch : {0.7, 0.9, 1.1, 1.5}) {
    setup.prescribed.clear();
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
      const Vec3d X = setup.mesh.points.col(v);
      for (int axis = 0; axis < 3; ++axis) {
        Axes only{};
        only[axis] = true;
        if (X[axis] == 0) setup.prescribed.push_back({v, Vec3d::Zero(), only});
        if (axis == 0 && X[0] > length - 1e-9)
          setup.prescribed.push_back({v, {(stretch - 1) * length, 9, 9}, only});
      }
    }
    const StaticResult result = solve_static(setup);
    REQUIRE(result.converged);
    const double side = std::sqrt(1 - nu * (stretch * stretch - 1));
    const Mat3<double> F = Vec3d(stretch, side, side).asDiagonal();
    CHECK((result.u - affine_displacement(setup.mesh.points, F)).norm() < 1e-8 * result.u.norm());
    // The same rollers in a world: reaction = P A, nothing sideways.
    World<double> world = world_at(setup, result.u);
    double force = 0;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (setup.mesh.points(0, v) == 0) force += world.forces()(0, v);
    const double P = E * stretch * (stretch * stretch - 1) / 2;
    CHECK(force == near(P * length * length, 1e-8));
  }
}

TEST_CASE(
    "nodal pressure loosens a nearly incompressible beam, and its equilibrium is that of the real-time "
    "forces") {
  // E = 3000, ν = 0.499, 2 × 2 × 8 cells of six tetrahedra: -4.4913 without, as published for such elements.
  const double E = 3000, nu = 0.499;
  Setup setup = setup_of(box_mesh({15, 15, 80}, 2, 2, 8));
  setup.materials[0] = {E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)), 1};
  Index tip = -1;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    if (setup.mesh.points(2, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
    if ((setup.mesh.points.col(v) - Vec3d(7.5, 7.5, 80)).norm() < 1e-9) tip = v;
  }
  for (const TetFace& face : outer_faces(setup.mesh)) {
    bool at_end = true;
    for (int c : face_corners[face.face])
      at_end = at_end && setup.mesh.points(2, setup.mesh.tets(c, face.tet)) == 80;
    if (at_end) setup.face_loads.push_back({face.tet, face.face, {0, -30, 0}});
  }
  double before = 0;
  for (const auto& [share, expected] :
       {std::pair(0.0, -4.4913), std::pair(0.985, -21.626), std::pair(1.0, -30.287)}) {
    setup.materials[0].nodal_pressure = share;
    const StaticResult result = solve_static(setup);
    REQUIRE(result.converged);
    CHECK(result.residual <= 1e-10);
    CHECK(result.u(1, tip) == near(expected, 1e-4));
    CHECK(result.u(1, tip) < before);
    before = result.u(1, tip);
    World<double> world = world_at(setup, result.u);
    double largest = 0;
    for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
      if (setup.mesh.points(2, v) > 0) largest = std::max(largest, world.forces().col(v).norm());
    CHECK(largest < 1e-8 * 30 * 15 * 15);
  }
}

TEST_CASE("a load without equilibrium ends with the fraction reached, the worst tetrahedron and a remedy") {
  Setup setup = setup_of(box_mesh({0.03, 0.03, 0.03}, 3, 3, 3));
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, Vec3d::Zero()});
  pull_end(setup, {-30000, 0, 0});  // SVK carries at most 0.19 E in compression
  StaticOptions options;
  options.smallest_load_step = 0.01;
  const StaticResult result = solve_static(setup, options);
  CHECK(!result.converged);
  CHECK(result.load_fraction > 0);
  CHECK(result.load_fraction < 0.3);
  CHECK(result.worst_tet >= 0);
  CHECK(result.reason.find("volume_penalty") != std::string::npos);
}
