// How stiff contact is beside selective masses: one number per degree, whatever was before.
#include "lobe/contact/softening.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "lobe/contact/contact.h"
#include "lobe/sim/checkpoint.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double height = 0.05;  // of the block [m]

Setup block(bool expandable = false) {
  Setup setup = setup_of(irregular_box(5));
  setup.selective_mass = 12;
  setup.damping = 10;
  setup.expandable = expandable;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  if (expandable)
    for (Index t = 0; t < setup.mesh.tet_count(); ++t)
      if (barycentre(setup.mesh, t).z() < height / 2)
        setup.region_of[std::size_t(t)] = RegionModel::precomputed;
  return setup;
}

template <class Real>
Contact<Real>& contact_of(World<Real>& world) {
  for (const auto& term : world.body().terms)
    if (auto* contact = dynamic_cast<Contact<Real>*>(term.get())) return *contact;
  FAIL("there is no contact");
  throw 0;
}

template <class Real>
double softening_of(World<Real>& world) {
  return contact_of(world).surface().softening();
}

// Presses on the top.
const BringProbe& ball() {
  static const BringProbe probe = [] {
    BringProbe brought{"ball", RigidShape::sphere(0.012), {}, 0};
    brought.pose.position = {0.025, 0.025, height + 0.0115};
    return brought;
  }();
  return probe;
}

// In contact after these commands and a frame, another degree, and a frame.
template <class Real>
World<Real> pressed(const Setup& setup, const std::vector<Command>& before, int degree) {
  World<Real> world(setup);
  for (const Command& command : before) world.apply(command);
  world.apply(ball());
  world.advance(0.005);
  world.apply(SetMassDegree{degree});
  world.advance(0.005);
  return world;
}

}  // namespace

TEST_CASE_TEMPLATE("contact is as soft as the degree of selective masses asks, whenever it is first seen",
                   Real, float, double) {
  const Setup setup = block();
  double last = 1.5;
  for (const int degree : {1, 3, 12}) {
    CAPTURE(degree);
    World<Real> plain = pressed<Real>(setup, {SetMassDegree{degree}}, degree);
    const double softening = softening_of(plain);
    CHECK((degree == 1 ? softening == 1 : softening < last));
    last = softening;
    for (const int first : {1, 3, 12}) {
      World<Real> other = pressed<Real>(setup, {SetMassDegree{first}}, degree);
      CHECK(softening_of(other) == softening);
    }
    World<Real> cut = pressed<Real>(setup, {RemoveTets{{5, 6, 7, 100}}, TakeHold{"grasp", {200}}}, degree);
    CHECK(softening_of(cut) == softening);
    World<Real> restored(setup);
    restored.restore(cut.save());
    CHECK(softening_of(restored) == softening);
    restored.advance(0.005);
    cut.advance(0.005);
    CHECK(same_bits(restored, cut));
  }
}

TEST_CASE("contact is as soft while a pre-computed region is expanded as before and after") {
  World<double> world(block(true));
  world.apply(ball());
  world.advance(0.005);
  const double softening = softening_of(world);
  CHECK(softening < 1);
  world.apply(Expand{});
  world.advance(0.005);
  CHECK(softening_of(world) == softening);
}

TEST_CASE("a world that is restored after a change of the degree is pressed as the one that was saved") {
  const Setup setup = block();
  World<double> world(setup), other(setup);
  world.apply(ball());
  world.advance(0.005);
  world.apply(SetMassDegree{3});
  other.restore(world.save());
  for (World<double>* each : {&world, &other}) {
    each->apply(SetForces{{{30, {0, 0, 0.01}}}});
    each->advance(0.005);
  }
  CHECK(same_bits(world, other));
}
