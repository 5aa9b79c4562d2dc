// What a haptic hand feels of a reduced body, against the same body all non-linear.
#include "haptic/virtual_loop.h"
#include "lattice/lattice_worlds.h"
#include "lobe/haptic/trial.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A block of 5 cm that stands on z = 0.
Setup block_to_feel(RegionModel model) {
  Setup setup = setup_of(irregular_box(8, 0.00625), model);
  setup.lattice_cell = 0.0125;
  setup.volume_penalty = 1e5;
  setup.damping = 15;
  setup.guard_below = 0.2;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(2, v) < 0.003) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

Setup bar_to_feel(RegionModel model) {
  Setup setup = bar(16, 4, true, model);
  setup.damping = 20;
  setup.guard_below = 0.2;
  return setup;
}

SimulatedHand::Path along(const bench::HandPath& path) {
  return [path](double time) -> Vec3d { return path.at(time); };
}

struct Felt {
  std::vector<Vec3d> forces;  // per tick [N]
  int reduced_ticks = 0;      // in which at most two thirds of the body were full
  double highest() const {
    double most = 0;
    for (const Vec3d& f : forces) most = std::max(most, f.norm());
    return most;
  }
};

// begin(controller) takes hold of the body or brings a tool.
template <class Begin>
Felt feel(const Setup& setup, const bench::HandPath& path, Begin&& begin) {
  VirtualLoop loop(setup, along(path), 1.0 / 120);
  begin(loop.controller);
  Felt felt;
  loop.run(path.duration(), [&](const HapticState& state) {
    felt.forces.push_back(state.force);
    const auto& region = loop.session.world().body().regions.reduced();
    felt.reduced_ticks +=
        region.any_embedded() && 3 * region.full_tet_count() < 2 * loop.setup.mesh.tet_count();
  });
  CHECK(loop.servo().state().limited == 0);
  CHECK(loop.servo().state().interventions == 0);
  CHECK(replays(loop.session, loop.setup));
  return felt;
}

struct Difference {
  double largest = 0, rms = 0;  // of the highest force
};

Difference difference(const Felt& felt, const Felt& exact) {
  REQUIRE(felt.forces.size() == exact.forces.size());
  Difference found;
  for (std::size_t i = 0; i < exact.forces.size(); ++i) {
    const double off = (felt.forces[i] - exact.forces[i]).norm();
    found.largest = std::max(found.largest, off);
    found.rms += off * off;
  }
  found.rms = std::sqrt(found.rms / double(exact.forces.size())) / exact.highest();
  found.largest /= exact.highest();
  return found;
}

Setup stiffer(Setup setup, double factor) {
  for (Elastic& e : setup.materials) {
    e.lambda *= factor;
    e.mu *= factor;
  }
  return setup;
}

// The tolerance can fail: tissue that is a tenth stiffer feels more different than that.
template <class Begin>
void check_feels_alike(Setup make(RegionModel), const bench::HandPath& path, Begin&& begin,
                       double tolerance) {
  const Felt exact = feel(make(RegionModel::nonlinear), path, begin),
             felt = feel(make(RegionModel::reduced), path, begin),
             other = feel(stiffer(make(RegionModel::nonlinear), 1.1), path, begin);
  const Difference reduced = difference(felt, exact), tenth = difference(other, exact);
  MESSAGE("highest force " << exact.highest() << " N; reduced: largest difference " << reduced.largest
                           << ", rms " << reduced.rms << "; a tenth stiffer: " << tenth.largest << ", "
                           << tenth.rms << "; reduced in " << felt.reduced_ticks << " of "
                           << felt.forces.size() << " ticks");
  CHECK(exact.highest() > 0.3);
  CHECK(2 * felt.reduced_ticks > int(felt.forces.size()));
  CHECK(reduced.rms < tolerance);
  CHECK(tenth.rms > tolerance);
}

}  // namespace

TEST_CASE("a hand that holds a reduced block and moves it feels it as it does a non-linear one") {
  const bench::HandPath path{{{Vec3d::Zero(), 0, 0.2},
                              {{0, 0, -0.006}, 0.1},
                              {Vec3d::Zero(), 0, 0.2},
                              {Vec3d::Zero(), 0.1},
                              {Vec3d::Zero(), 0, 0.2}}};
  check_feels_alike(
      block_to_feel, path, [](Controller& hands) { hands.send(take_at(top)); }, 0.02);
}

TEST_CASE("a probe in a hand that slides over a reduced bar feels it as it does a non-linear one") {
  constexpr double radius = 0.012;
  const Vec3d tip(0.09, 0.02, 0.04 + radius + 0.004);
  const bench::HandPath path{{{Vec3d::Zero(), 0, 0.2},
                              {{0, 0, -0.014}, 0.05},
                              {Vec3d::Zero(), 0, 0.2},
                              {{0.015, 0, -0.014}, 0.05},
                              {Vec3d::Zero(), 0.05},
                              {Vec3d::Zero(), 0, 0.2}}};
  const BringProbe probe{"", RigidShape::sphere(radius), {.position = tip}, 0.1};
  check_feels_alike(
      bar_to_feel, path, [&](Controller& hands) { hands.send(bring_tool(1, tip, probe)); }, 0.025);
}

TEST_CASE("the trial chooses no frames of 1 ms for a reduced body, however fast it is") {
  const HapticTrial trial = try_direct<float>(block_to_feel(RegionModel::reduced), 1, 50);
  CHECK(trial.p99 > 0);
  CHECK_FALSE(trial.is_direct);
}
