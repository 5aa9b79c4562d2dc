// The shipped scene of a cut that three stitches close.
#include <doctest/doctest.h>

#include <algorithm>

#include "lobe/forces/embedded.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/scalpel/grains.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/sim/world.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Where the material is that was at X, once blades have cut [m].
Vec3d place_now(World<float>& world, const Vec3d& X) {
  const Elements& elements = world.elements();
  const auto u = world.displacements();
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Eigen::Vector4d weights = barycentric(elements.corner_points(t), X);
    if (weights.minCoeff() < -1e-9 || distance_to_material(X, t, elements, world.grains()) > 1e-9) continue;
    return X + u(Eigen::all, elements.topology.corners(t)).template cast<double>() * weights;
  }
  FAIL("no tetrahedron has this point");
  return X;
}

// The widest gap between both lips of the cut at x = 40.3 mm, near the surface [m].
double widest_gap(World<float>& world) {
  constexpr double beside = 1e-3;  // the tissue has moved a little when it is cut
  const double z = world.elements().points.view().row(2).maxCoeff() - 3e-4;
  double widest = 0;
  for (double y = 0.0152; y < 0.046; y += 0.002) {
    const Vec3d left = place_now(world, {0.0403 - beside, y, z}),
                right = place_now(world, {0.0403 + beside, y, z});
    widest = std::max(widest, (right - left).norm() - 2 * beside);
  }
  return widest;
}

}  // namespace

TEST_CASE("three stitches close a cut of 40 mm") {
  const Scene scene = read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / "incision_closed.json");
  const TetMesh mesh = read_mesh(mesh_path(scene)).mesh;
  const TetMesh made = box_mesh({0.08, 0.06, 0.012}, 16, 12, 4);
  CHECK(mesh.points == made.points);
  CHECK(mesh.tets == made.tets);
  const Resolved resolved = resolve(scene, mesh);
  CHECK(resolved.warnings.empty());
  World<float> world(resolved.setup);
  const auto run_to = [&](double time) {
    while (world.time() < time - 1e-9) REQUIRE(world.advance(scene.time.frame).ok);
  };
  run_to(1.6);
  const double open = widest_gap(world);
  run_to(scene.time.duration);
  const double closed = widest_gap(world);
  MESSAGE("gap: ", open * 1e3, " mm, closed ", closed * 1e3, " mm");
  CHECK(open > 0.003);
  CHECK(closed < 0.0003);
  for (const ThreadLine& line : thread_lines(world))
    for (const double tension : line.tensions) CHECK(tension < resolved.setup.stitches[0].material.holds);
}
