// Own steps beside what tools do: blades that divide a body, and probes that press on it.
#include <doctest/doctest.h>

#include <algorithm>

#include "lobe/sim/checkpoint.h"
#include "lobe/sim/validate.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame_of_tools = 0.02;  // [s]

// A bar along x of 24 × 3 × 3 cells, held where x is least, whose last two layers are stiff.
Setup bar_with_stiff_tip() {
  Setup setup = setup_of(box_mesh({0.24, 0.03, 0.03}, 24, 3, 3));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> jitter(-0.0015, 0.0015);
  for (double& x : setup.mesh.points.reshaped()) x += jitter(random);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.005) setup.prescribed.push_back({v});
  setup.materials = {{8e3, 2e3, 1000}, {4e5, 1e5, 1000}};
  for (Index t = 0; t < setup.mesh.tet_count(); ++t)
    setup.material_of[std::size_t(t)] = barycentre(setup.mesh, t).x() > 0.22;
  setup.gravity = {0, 0.3, 0};
  setup.damping = 10;
  setup.own_steps = true;
  return setup;
}

// A blade that falls through the bar from 0.1 s on.
Setup bar_that_is_cut() {
  Setup setup = bar_with_stiff_tip();
  setup.scalpels.push_back({"blade",
                            0.1,
                            {{0.1, {0.103, -0.02, 0.05}}, {0.5, {0.107, -0.02, -0.01}}},
                            {{0.103, 0.08, 0.05}, {0.107, 0.08, -0.01}}});
  return setup;
}

// A ball that comes down on the soft end and goes up again.
Setup bar_that_is_touched() {
  Setup setup = bar_with_stiff_tip();
  setup.probes.push_back({"ball",
                          RigidShape::sphere(0.012),
                          0.1,
                          {{0, {0.03, 0.015, 0.06}},
                           {0.2, {0.03, 0.015, 0.038}},
                           {0.3, {0.03, 0.015, 0.038}},
                           {0.5, {0.03, 0.015, 0.08}}}});
  return setup;
}

template <class Real>
bool are_of_same_bits(World<Real>& a, World<Real>& b) {
  return a.state().u == b.state().u && a.state().v == b.state().v;
}

}  // namespace

TEST_CASE("a body with own steps is cut as one that steps together is") {
  Setup setup = bar_that_is_cut();
  World<double> own(setup), restored(setup, 2);
  setup.own_steps = false;
  World<double> one(setup);
  double area = 0, of_one = 0;
  int by_levels = 0;
  for (int i = 0; i < 35; ++i) {
    if (i == 15) restored.restore(own.save());
    const Report report = own.advance(frame_of_tools);
    REQUIRE(report.ok);
    if (i >= 15) restored.advance(frame_of_tools);
    area += report.cut_area;
    of_one += one.advance(frame_of_tools).cut_area;
    by_levels += own.body().own_steps->any();
    if (i == 20) CHECK(own.body().own_steps->any());  // amid the cut
  }
  validate(own);
  CHECK(own.grains());
  CHECK(area > 4e-4);
  CHECK(area == near(of_one, 0.05));
  CHECK(by_levels > 30);
  CHECK(are_of_same_bits(own, restored));
  const double most = one.state().u.colwise().norm().maxCoeff();
  CHECK(most > 1e-3);
  CHECK(own.state().u.colwise().norm().maxCoeff() == near(most, 0.05));
}

TEST_CASE("a probe presses on a body with own steps as on one that steps together") {
  Setup setup = bar_that_is_touched();
  World<double> own(setup), restored(setup, 2);
  setup.own_steps = false;
  World<double> one(setup);
  const auto force = [](World<double>& world) { return world.tools().lists().probes.front().force; };
  double most = 0, difference = 0;
  bool was_by_levels = false;
  for (int i = 0; i < 30; ++i) {
    if (i == 8) restored.restore(own.save());
    REQUIRE(own.advance(frame_of_tools).ok);
    if (i >= 8) restored.advance(frame_of_tools);
    one.advance(frame_of_tools);
    most = std::max(most, force(one).norm());
    difference = std::max(difference, (force(own) - force(one)).norm());
    was_by_levels = was_by_levels || own.body().own_steps->any();
  }
  CHECK(most > 0.01);
  CHECK(difference < 0.02 * most);
  CHECK(was_by_levels);
  CHECK(are_of_same_bits(own, restored));
  const Mat3X<double> u = one.state().u;
  CHECK((own.state().u - u).norm() < 0.01 * u.norm());
}
