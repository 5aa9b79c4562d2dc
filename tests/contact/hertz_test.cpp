// Two elastic spheres that are pressed on each other.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "lobe/mesh/generators.h"
#include "lobe/mesh/joined_mesh.h"
#include "near.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double poisson = 0.3, size = 0.1, radius_below = 0.04, radius_above = 0.08, approach = 2e-4;

// A quarter of a block whose upper side is that of a sphere around (0, 0, 0), as far as that matters. Cells
// are finest there: of 8 along a side, 0.75 mm, and 1.2 mm at the rim of the contact.
TetMesh quarter(int n, double radius) {
  constexpr double flat_beyond = 0.04;
  TetMesh mesh = box_mesh(Vec3d::Constant(1), n, n, n);
  for (double& s : mesh.points.reshaped()) s = size * (0.06 * s + 0.94 * std::pow(s, 5));
  for (auto x : mesh.points.colwise()) {
    const double r = std::min(x.head<2>().norm(), flat_beyond);
    x[2] = -x[2] - r * r / (2 * radius) * (1 - x[2] / size);
  }
  mesh.tets.row(0).swap(mesh.tets.row(1));
  return mesh;
}

TetMesh turned_over(TetMesh mesh) {
  mesh.points.row(2) *= -1;
  mesh.tets.row(0).swap(mesh.tets.row(1));
  return mesh;
}

// The upper one is that many times as stiff, and as dense, so that both have the same step.
Setup two_spheres(int n, double young, double contrast) {
  Setup setup;
  append_body(quarter(n, radius_below), "below", setup.mesh);
  append_body(turned_over(quarter(n, radius_above)), "above", setup.mesh);
  for (double times : {1.0, contrast}) {
    Elastic& own = setup.materials.emplace_back();
    own.lambda = times * young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    own.mu = times * young / (2 * (1 + poisson));
    own.density = times * 1000;
    own.element = ElementType::edge_smoothed;
  }
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.material_of.push_back(std::uint16_t(setup.mesh.bodies.body_of(t)));
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), RegionModel::nonlinear);
  setup.contact.self = true;
  setup.contact.friction = 0;
  setup.damping = 120;
  return setup;
}

// The force over that of Hertz' formula.
double press_spheres(int n, double contrast) {
  constexpr double young = 2e4, press = 0.1, frame = 1.0 / 60;
  Setup setup = two_spheres(n, young, contrast);
  std::vector<Index> top;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const Vec3d x = setup.mesh.points.col(v);
    const Axes sides{x[0] == 0, x[1] == 0, false};
    if (x[2] > 0.999 * size) top.push_back(v);
    if (x[2] < -0.999 * size)
      setup.prescribed.push_back({v, Vec3d::Zero()});
    else if (sides != Axes{})
      setup.prescribed.push_back({v, Vec3d::Zero(), sides});
  }
  setup.grasps.push_back(
      {"plate", top, {{0, {0, 0, 0}}, {press, {0, 0, -approach}}, {9, {0, 0, -approach}}}});
  World<float> world(setup, 2);
  for (int i = 0; i < 18; ++i) REQUIRE(world.advance(frame).ok);
  const double modulus = young / (1 - poisson * poisson) / (1 + 1 / contrast);
  const double radius = 1 / (1 / radius_below + 1 / radius_above);
  const double hertz = 4.0 / 3 * modulus * std::sqrt(radius) * std::pow(approach, 1.5);
  return 4 * std::abs(world.body().reaction(1).z()) / hertz;
}

}  // namespace

TEST_CASE("two spheres that are pressed on each other feel Hertz' force, whichever is stiffer by how much") {
  for (double contrast : {1.0, 10.0, 100.0}) {
    CAPTURE(contrast);
    const double force = press_spheres(8, contrast);
    MESSAGE("contrast " << contrast << ": force over Hertz' " << force);
    CHECK(force == near(1, 0.05));
  }
}
