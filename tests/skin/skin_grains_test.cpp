// A skin on what a blade has cut.
#include <doctest/doctest.h>

#include "lobe/mesh/refine.h"
#include "lobe/scalpel/incise.h"
#include "lobe/sim/world.h"
#include "lobe/skin/skin.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double plane = 0.0437;   // where x is that the blade falls [m]
constexpr double snapped = 0.003;  // the cut is off it by at most a tenth of an edge [m]

Setup box_and_blade(double depth) {
  Setup setup = setup_of(irregular_box(5, 0.02));
  setup.scalpels.push_back({"blade",
                            0.1,
                            {{0.001, {plane, -0.1, 0.12}}, {0.05, {plane, -0.1, 0.12 - depth}}},
                            {{plane, 0.2, 0.12}, {plane, 0.2, 0.12 - depth}}});
  return setup;
}

double area_of(const Skin& skin, const TexturedSurface& surface) {
  double area = 0;
  for (const Eigen::Vector3i& t : skin.mesh().triangles) {
    Mat3<double> X;
    for (int k = 0; k < 3; ++k) X.col(k) = surface.points.col(skin.mesh().file_vertex[std::size_t(t[k])]);
    area += (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0)).norm() / 2;
  }
  return area;
}

}  // namespace

TEST_CASE("a skin opens along the cut: each side keeps its triangles, and those across go") {
  const Setup setup = box_and_blade(0.15);
  const TexturedSurface surface = textured_boundary(refine(refine(setup.mesh).mesh).mesh);
  Skin skin(surface, setup.mesh);
  const double before = area_of(skin, surface);
  World<double> world(setup);
  world.on_cut(
      [&](const Topology& topology, const MeshEdit& edit) { skin.follow(topology, edit, world.grains()); });
  for (int i = 0; i < 6; ++i) world.advance(0.01);
  REQUIRE(world.elements().topology.pieces().size() == 2);
  // Each side is moved away by itself: what is left of the skin is on one of them, and as it was.
  State<double> state = world.state();
  for (const std::vector<Index>& piece : world.elements().topology.pieces())
    for (Index t : piece) {
      bool is_left = false;
      for (Index other : piece)
        for (Index v : world.elements().topology.corners(other))
          is_left = is_left || world.elements().points(0, v) < 0.01;
      for (Index v : world.elements().topology.corners(t)) state.u.col(v) = Vec3d(is_left ? -1 : 1, 0, 0);
      if (t == piece.back()) break;
    }
  Mat3X<float> x, normals;
  skin.update(world.elements().points.view(), state.u, x, normals);
  double farthest = 0;
  int across = 0;
  for (const Eigen::Vector3i& t : skin.mesh().triangles) {
    double low = 1, high = -1;
    for (Index v : t) {
      const Vec3d X = surface.points.col(skin.mesh().file_vertex[std::size_t(v)]);
      const double side = X.x() < plane ? -1 : 1;
      if (std::abs(X.x() - plane) > snapped)
        farthest = std::max(farthest, (x.col(v).cast<double>() - X - Vec3d(side, 0, 0)).norm());
      low = std::min(low, X.x());
      high = std::max(high, X.x());
    }
    across += low < plane - snapped && high > plane + snapped;
  }
  CHECK(farthest < 1e-5);
  CHECK(across == 0);
  // What goes is a strip as wide as a triangle, 5 mm, around the body, 0.4 m, at most twice of it.
  const double lost = before - area_of(skin, surface);
  CHECK(lost > 0);
  CHECK(lost < 2 * 0.005 * 0.4);
  // The same for all edits at once.
  Skin late(surface, setup.mesh);
  late.follow_all(world.elements().topology, world.grains());
  CHECK(late.mesh().triangle_count() == skin.mesh().triangle_count());
}

TEST_CASE(
    "a skin that is not told of grains keeps to the tetrahedra of the start, and shows no triangle across a "
    "gap of "
    "tetrahedra") {
  const Setup setup = box_and_blade(0.15);
  const TexturedSurface surface = textured_boundary(refine(setup.mesh).mesh);
  Skin skin(surface, setup.mesh);
  World<double> world(setup);
  world.on_cut([&](const Topology& topology, const MeshEdit& edit) { skin.follow(topology, edit); });
  for (int i = 0; i < 6; ++i) world.advance(0.01);
  world.remove_tets({world.elements().topology.tet_count() - 1, 0, 7});  // of which the first is a copy
  CHECK(skin.mesh().triangle_count() > 0);
  CHECK(skin.mesh().triangle_count() < surface.triangles.cols());
}
