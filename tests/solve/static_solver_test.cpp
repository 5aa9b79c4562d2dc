#include "lobe/solve/static_solver.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/select.h"
#include "lobe/sim/world.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

Setup beam(RegionModel model) {
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
  Setup setup = beam(RegionModel::nonlinear);
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
