#include "lobe/linearity/proposal.h"

#include <doctest/doctest.h>

#include "fibre_support.h"
#include "liver.h"
#include "lobe/sim/world.h"
#include "lobe/solve/static_solver.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Of a machine that is not measured here, so that the same is proposed under any load.
constexpr StepCost usual_cost{7e-9, 4e-9, 8e-9, 4e-11};

Gesture lift(const Setup& setup, const Vec3d& by) {
  const std::vector<Index> vertices = left_lobe(setup);
  return {"lift", vertices, std::vector<Vec3d>(vertices.size(), by), Vec3d::Zero()};
}

double measured_error(const Setup& setup, const Gesture& gesture, const std::vector<RegionModel>& region_of) {
  Setup hybrid = at_the_end_of(gesture, setup);
  const Mat3X<double> exact = solve_static(hybrid).u;
  for (std::size_t t = 0; t < region_of.size(); ++t)
    hybrid.region_of[t] =
        region_of[t] == RegionModel::nonlinear ? RegionModel::nonlinear : RegionModel::tensor_mass;
  const Mat3X<double> found = solve_static(hybrid).u;
  double difference = 0, all = 0;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const double volume = signed_volume(tet_points(setup.mesh, t));
    for (Index v : setup.mesh.tets.col(t)) {
      difference += volume * (found.col(v) - exact.col(v)).squaredNorm();
      all += volume * exact.col(v).squaredNorm();
    }
  }
  return std::sqrt(difference / all);
}

}  // namespace

TEST_CASE(
    "proposed regions keep the tolerance, as a solution of their own tells, and a larger one gives more") {
  const Setup setup = held_liver();
  const Gesture gesture = lift(setup, {0.004, -0.004, 0.03});
  double share = 0;
  for (const double tolerance : {0.01, 0.04}) {
    ProposalOptions options;
    options.tolerance = tolerance;
    options.condense = false;
    options.cost = usual_cost;
    const Proposal proposal = propose_regions(setup, {gesture}, options);
    REQUIRE(proposal.gestures.size() == 1);
    const GestureOutcome& outcome = proposal.gestures[0];
    CHECK(outcome.measured <= tolerance);
    CHECK(measured_error(setup, gesture, proposal.region_of) == near(outcome.measured, 1e-4));
    CHECK(proposal.linear_share > share);
    share = proposal.linear_share;
  }
  CHECK(share > 0.3);
}

TEST_CASE("regions of a body with fibres keep the tolerance, as a solution of their own tells") {
  Setup setup = held_liver();
  setup.materials = {fibrous()};
  setup.mesh.fibres = fibrous_setup(setup.mesh).mesh.fibres;
  const Gesture gesture = lift(setup, {0.004, -0.004, 0.03});
  ProposalOptions options;
  options.condense = false;
  options.cost = usual_cost;
  const Proposal proposal = propose_regions(setup, {gesture}, options);
  const GestureOutcome& outcome = proposal.gestures.at(0);
  CHECK(outcome.measured <= options.tolerance);
  CHECK(measured_error(setup, gesture, proposal.region_of) == near(outcome.measured, 1e-4));
  CHECK(proposal.linear_share > 0.2);
}

TEST_CASE("regions of edge-smoothed tetrahedra keep the tolerance, as a solution of their own tells") {
  const Setup setup = smoothed(held_liver());
  const Gesture gesture = lift(setup, {0.004, -0.004, 0.03});
  ProposalOptions options;
  options.condense = false;
  options.cost = usual_cost;
  const Proposal proposal = propose_regions(setup, {gesture}, options);
  const GestureOutcome& outcome = proposal.gestures.at(0);
  CHECK(outcome.measured <= options.tolerance);
  CHECK(measured_error(setup, gesture, proposal.region_of) == near(outcome.measured, 1e-4));
  MESSAGE("linear share " << proposal.linear_share << ", measured " << outcome.measured);
  CHECK(proposal.linear_share > 0.2);
}

TEST_CASE("precomputed regions are anchored, and as exact as they were proposed") {
  const Setup setup = held_liver();
  const Gesture gesture = lift(setup, {0.004, -0.004, 0.03});
  ProposalOptions options;
  options.cost = usual_cost;
  options.tensor_mass = false;  // what is linear is precomputed
  const Proposal proposal = propose_regions(setup, {gesture}, options);
  REQUIRE(std::count(proposal.region_of.begin(), proposal.region_of.end(), RegionModel::precomputed) > 0);
  CHECK(measured_error(setup, gesture, proposal.region_of) == near(proposal.gestures[0].measured, 1e-4));
  CHECK(proposal.gestures[0].measured <= options.tolerance);
  Setup hybrid = setup;
  hybrid.region_of = proposal.region_of;
  CHECK_NOTHROW(World<float>{hybrid});
}

TEST_CASE(
    "beside what is precomputed all is non-linear, so that nothing keeps an error once it is expanded") {
  const Setup setup = held_liver();
  const Gesture gesture = lift(setup, {0.004, -0.004, 0.03});
  int precomputed = 0;
  for (const double tolerance : {0.005, 0.01, 0.02}) {
    ProposalOptions options;
    options.tolerance = tolerance;
    options.cost = usual_cost;
    const std::vector<RegionModel> regions = propose_regions_to_correct(setup, {gesture}, options).region_of;
    if (std::count(regions.begin(), regions.end(), RegionModel::precomputed) == 0) continue;
    ++precomputed;
    CHECK(std::count(regions.begin(), regions.end(), RegionModel::tensor_mass) == 0);
  }
  CHECK(precomputed > 0);
}

TEST_CASE("for a given cost the same regions are proposed again, and pay as predicted") {
  const Setup setup = held_liver();
  const Gesture gesture = lift(setup, {0.004, -0.004, 0.03});
  ProposalOptions options;
  options.cost = usual_cost;
  const Proposal one = propose_regions(setup, {gesture}, options),
                 other = propose_regions(setup, {gesture}, options);
  CHECK(one.region_of == other.region_of);
  CHECK(one.measured_speedup > 1);
  CHECK(one.measured_speedup == one.predicted_speedup);
  options.cost->tensor_mass = options.cost->nonlinear;
  options.cost->dense = 1e-6;
  CHECK(propose_regions(setup, {gesture}, options).linear_share == 0);
}

TEST_CASE("a tolerance that nothing linear meets leaves all non-linear, and says so") {
  Setup bar = setup_of(box_mesh({0.12, 0.03, 0.03}, 12, 3, 3));
  Gesture bend{"bend", {}, {}, {0, 0, 0.02}};
  for (Index v = 0; v < bar.mesh.vertex_count(); ++v) {
    if (bar.mesh.points(0, v) < 1e-9) bar.prescribed.push_back({v, Vec3d::Zero()});
    if (bar.mesh.points(0, v) > 0.12 - 1e-9) bend.vertices.push_back(v);
  }
  ProposalOptions options;
  options.tolerance = 1e-9;
  const Proposal proposal = propose_regions(bar, {bend}, options);
  CHECK(proposal.region_of == bar.region_of);
  CHECK(proposal.measured_speedup == 1);
  REQUIRE(proposal.notes.size() == 1);
  CHECK(proposal.notes[0].find("no zone keeps the error below") != std::string::npos);
}

TEST_CASE("a body that nothing holds has nothing linear, and says so") {
  Setup setup = held_liver();
  const Gesture gesture = lift(setup, {0, 0, 0.03});
  setup.prescribed.clear();
  Gesture force = gesture;
  force.displacements.clear();
  force.force = {0, 0, 1};
  const Proposal proposal = propose_regions(setup, {force}, {});
  CHECK(proposal.region_of == setup.region_of);
  REQUIRE(proposal.notes.size() == 1);
  CHECK(proposal.notes[0].find("nothing is linear") == 0);
  CHECK(proposal.notes[0].find("could move freely") != std::string::npos);
}

TEST_CASE("a gesture that has no equilibrium at its end counts as far as it goes") {
  const Setup setup = held_liver();
  Gesture push = lift(setup, {-0.15, 0.05, -0.05});
  push.name = "through itself";
  const Proposal proposal = propose_regions(setup, {push}, {});
  REQUIRE(proposal.gestures.size() == 1);
  CHECK(proposal.gestures[0].reached < 1);
  REQUIRE_FALSE(proposal.notes.empty());
  CHECK(proposal.notes[0].find("gesture \"through itself\" was followed to") == 0);
}

TEST_CASE("usual gestures pull outwards at places far from what is held and from each other") {
  const Setup setup = held_liver();
  const std::vector<Gesture> gestures = usual_gestures(setup);
  CHECK(gestures.size() == 5);
  for (const Gesture& gesture : gestures) {
    CHECK_FALSE(gesture.vertices.empty());
    CHECK(gesture.displacements[0].norm() > 0.01);
    for (Index v : gesture.vertices)
      for (const PrescribedVertex& p : setup.prescribed) CHECK(p.vertex != v);
  }
}

TEST_CASE("a tolerance outside of 0 to 1 is refused") {
  ProposalOptions options;
  options.tolerance = 0;
  CHECK_THROWS_WITH(propose_regions(held_liver(), {}, options),
                    doctest::Contains("must be above 0 and below 1"));
}

TEST_CASE("regions to correct are precomputed where that pays, and no larger than an error of 7 % allows") {
  const Setup setup = held_liver();
  const Gesture gesture = lift(setup, {0.004, -0.004, 0.03});
  const auto regions = [&](double tolerance) {
    ProposalOptions options;
    options.tolerance = tolerance;
    options.cost = usual_cost;
    return propose_regions_to_correct(setup, {gesture}, options).region_of;
  };
  const auto count = [](const std::vector<RegionModel>& region_of, RegionModel model) {
    return std::count(region_of.begin(), region_of.end(), model);
  };
  const std::vector<RegionModel> small = regions(0.01), large = regions(0.03);
  CHECK(count(small, RegionModel::precomputed) > 0);
  CHECK(count(large, RegionModel::precomputed) > count(small, RegionModel::precomputed));
  CHECK(regions(0.06) == large);
}

TEST_CASE("regions to correct may be asked for with any tolerance below 1") {
  Setup bar = setup_of(box_mesh({0.06, 0.02, 0.02}, 6, 2, 2));
  for (Index v = 0; v < bar.mesh.vertex_count(); ++v)
    if (bar.mesh.points(0, v) == 0) bar.prescribed.push_back({v, Vec3d::Zero()});
  ProposalOptions options;
  options.tolerance = 0.5;
  CHECK_NOTHROW(
      propose_regions_to_correct(bar, {{"push", {bar.mesh.vertex_count() - 1}, {}, {0, 0, 0.01}}}, options));
}
