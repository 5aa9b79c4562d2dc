// Corotational regions: against tensor-mass and non-linear ones, rotations, the solvers, and themselves after
// edits.
#include "lobe/region/corotational.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lobe/diagnostics/fields.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/sim/rebuild.h"
#include "lobe/solve/static_solver.h"
#include "lobe/solve/tangent.h"
#include "lobe/time/vertex_frequencies.h"
#include "near.h"
#include "support.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr RegionModel corotational = RegionModel::corotational;

Mat3<double> turn(double angle) {
  return Eigen::AngleAxisd(angle, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
}

// The half of the tetrahedra with the smaller x corotational.
Setup half_corotational(const TetMesh& mesh, RegionModel other) {
  Setup setup = setup_of(mesh, other);
  for (Index t = 0; t < mesh.tet_count(); ++t)
    if (barycentre(mesh, t).x() < mesh.points.row(0).mean()) setup.region_of[std::size_t(t)] = corotational;
  return setup;
}

// The same body of both elements.
std::array<Setup, 2> of_both_elements(const Setup& setup) { return {setup, smoothed(setup)}; }

// The largest force on an inner vertex, relative to the largest of all.
double inner_force(const Setup& setup, const Mat3X<double>& f) {
  const Topology topology(setup.mesh);
  std::vector<bool> is_outer(std::size_t(setup.mesh.vertex_count()), false);
  for (Index code : topology.boundary_faces())
    for (Index v : topology.face(code)) is_outer[std::size_t(v)] = true;
  double largest = 0;
  for (Index v = 0; v < f.cols(); ++v)
    if (!is_outer[std::size_t(v)]) largest = std::max(largest, f.col(v).norm());
  return largest / f.colwise().norm().maxCoeff();
}

// A bar along x, clamped at one end.
Setup bar(RegionModel model) {
  Setup setup = setup_of(box_mesh({0.12, 0.02, 0.02}, 12, 2, 2), model);
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 1e-9) setup.prescribed.push_back({v, Vec3d::Zero()});
  return setup;
}

// Bent to a quarter of a circle: both ends are held where a beam of this length would have them.
StaticResult bent(RegionModel model, bool is_smoothed = false) {
  Setup setup = is_smoothed ? smoothed(bar(model)) : bar(model);
  const double length = 0.12, angle = std::numbers::pi / 2, radius = length / angle;
  const Mat3<double> R = Eigen::AngleAxisd(angle, Vec3d::UnitZ()).toRotationMatrix();
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const Vec3d X = setup.mesh.points.col(v), axis(length, 0.01, 0.01);
    if (X.x() < length - 1e-9) continue;
    const Vec3d end = Vec3d(0, 0.01, 0.01) + radius * Vec3d(std::sin(angle), 1 - std::cos(angle), 0);
    setup.prescribed.push_back({v, end + R * (X - axis) - X});
  }
  StaticResult result = solve_static(setup);
  CHECK(result.converged);
  return result;
}

}  // namespace

TEST_CASE("patch test: an affine map gives no force inside a corotational body, turned or not") {
  const TetMesh mesh = irregular_box(4);
  Mat3<double> F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1;
  for (const Mat3<double>& deformed : {F, Mat3<double>(turn(2) * F)}) {
    const Mat3X<double> u = affine_displacement(mesh.points, deformed);
    const double density =
        law_energy_density<double>(corotational_law(seed_material), F - Mat3<double>::Identity());
    for (const Setup& setup : of_both_elements(setup_of(mesh, corotational))) {
      CHECK(inner_force(setup, forces<double>(setup, u)) < 1e-12);
      CHECK(elastic_energy(setup, u) == near(total_volume(mesh) * density, 1e-12));
    }
  }
}

// Without rotation the law is Hooke's.
TEST_CASE("patch test across interfaces: linear regions have the same stress at a pure strain of any size") {
  const TetMesh mesh = irregular_box(4);
  Mat3<double> F;
  F << 1.2, 0.1, -0.1, 0.1, 0.8, 0.15, -0.1, 0.15, 1.1;
  const Mat3X<double> u = affine_displacement(mesh.points, F);
  const Mat3X<double> linear = forces<double>(setup_of(mesh, RegionModel::tensor_mass), u);
  for (const Setup& setup : of_both_elements(half_corotational(mesh, RegionModel::tensor_mass))) {
    CHECK(inner_force(setup, forces<double>(setup, u)) < 1e-12);
    CHECK((forces<double>(setup, u) - linear).norm() < 1e-12 * linear.norm());
  }
}

TEST_CASE("patch test across interfaces: other regions have the same stress at a small strain, far turned") {
  const TetMesh mesh = irregular_box(4);
  const double size = 1e-8;
  Mat3<double> strain;
  strain << 1, 0.3, -0.2, 0.3, -0.5, 0.1, -0.2, 0.1, 0.4;
  const Mat3<double> F = turn(2) * (Mat3<double>::Identity() + size * strain);
  const Mat3X<double> u = affine_displacement(mesh.points, F);
  const double rounding = 1e-15 / size;
  for (RegionModel other : {RegionModel::nonlinear, RegionModel::reduced}) {
    const Setup setup = half_corotational(mesh, other);  // the solver's forces: no vertex follows a lattice
    CHECK(inner_force(setup, energy_and_forces(Elements(setup), u).forces) < 10 * rounding);
  }
  const Setup setup = half_corotational(mesh, RegionModel::nonlinear);
  CHECK(inner_force(setup, forces<double>(setup, u)) < 10 * rounding);
}

TEST_CASE("beside a precomputed part that is held, forces are those beside a tensor-mass one") {
  Setup setup = half_corotational(irregular_box(4), RegionModel::precomputed), linear = setup;
  for (RegionModel& region : linear.region_of)
    if (region == RegionModel::precomputed) region = RegionModel::tensor_mass;
  for (Setup* each : {&setup, &linear}) {
    for (Index v = 0; v < each->mesh.vertex_count(); ++v)
      if (each->mesh.points(0, v) > 0.036) each->prescribed.push_back({v, Vec3d::Zero()});
    each->vertex_loads.push_back({0, {0.02, 0.01, -0.03}});
  }
  const StaticResult condensed = solve_static(setup), exact = solve_static(linear);
  CHECK((condensed.u - exact.u).norm() < 1e-12 * exact.u.norm());
  World<double> world(setup);
  State<double> state = world.state();
  state.u = exact.u;
  world.set_state(state);
  double largest = 0, load = 0;
  for (Index v = 0; v < exact.u.cols(); ++v)
    if (!world.held().anchors(v) && !world.body().regions.follows(v))
      largest = std::max(largest, (world.forces().col(v) + exact.reactions.col(v)).norm());
  for (const VertexLoad& item : setup.vertex_loads) load += item.force.norm();
  CHECK(largest < 1e-9 * load);
}

TEST_CASE("it is the tensor-mass region but for what is of second order in displacements") {
  const TetMesh mesh = irregular_box(3);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 1e-3);
  const auto difference = [&](double size) {
    const Mat3X<double> linear = forces<double>(setup_of(mesh, RegionModel::tensor_mass), size * u);
    return (forces<double>(setup_of(mesh, corotational), size * u) - linear).norm() / linear.norm();
  };
  const double large = difference(0.1), half = difference(0.05);
  CHECK(half < 0.02);
  CHECK(std::log2(large / half) == near(1, 0.03));
}

TEST_CASE_TEMPLATE("a rigid motion costs nothing, and a translation not even a rounding", Real, float,
                   double) {
  const TetMesh mesh = irregular_box();
  const Setup setup = setup_of(mesh, corotational);
  const double scale = 1e4 * 0.01 * 0.01;  // μ × area of a face
  for (double angle : {0.3, 2.0, 3.14159}) {
    const Mat3X<Real> u = affine_displacement(mesh.points, turn(angle)).template cast<Real>();
    const double rounding = 200 * std::numeric_limits<Real>::epsilon();
    CHECK(forces<Real>(setup, u).norm() < rounding * scale);
    CHECK(elastic_energy(setup, u.template cast<double>()) < rounding * rounding * scale);
  }
  const Mat3X<Real> moved = Vec3<Real>(0.25f, -0.5f, 0.125f).replicate(1, mesh.vertex_count());
  CHECK(forces<Real>(setup, moved).norm() == 0);
}

TEST_CASE("forces turn with the body, and add up to no force and no moment") {
  const TetMesh mesh = irregular_box(3);
  const Mat3X<double> u = random_displacement(mesh.vertex_count(), 2e-3), x = mesh.points + u;
  const Mat3X<double> turned = turn(2.5) * x - mesh.points;
  for (const Setup& setup : of_both_elements(setup_of(mesh, corotational))) {
    const Mat3X<double> f = forces<double>(setup, u);
    CHECK((forces<double>(setup, turned) - turn(2.5) * f).norm() < 1e-12 * f.norm());
    CHECK(elastic_energy(setup, turned) == near(elastic_energy(setup, u), 1e-12));
    CHECK(f.rowwise().sum().norm() < 1e-13 * f.norm());
    Vec3d moment = Vec3d::Zero();
    for (Index v = 0; v < mesh.vertex_count(); ++v) moment += Vec3d(x.col(v)).cross(Vec3d(f.col(v)));
    CHECK(moment.norm() < 1e-12 * f.norm() * 0.03);
  }
}

TEST_CASE("forces are minus the slope of the energy in a corotational half and at its interface") {
  const TetMesh mesh = irregular_box(2);
  const Mat3X<double> u =
      affine_displacement(mesh.points, turn(1.2)) + random_displacement(mesh.vertex_count(), 2e-3);
  for (RegionModel other : {RegionModel::nonlinear, RegionModel::tensor_mass})
    for (const Setup& setup : of_both_elements(half_corotational(mesh, other)))
      check_that_forces_are_minus_the_slope_of_the_energy(setup, u);
}

TEST_CASE("solvers, the time step and fields follow the law of a corotational tetrahedron") {
  TetMesh mesh = irregular_box(1);
  const Setup setup = setup_of(mesh, corotational);
  const Elements elements(setup);
  const Mat3X<double> u =
      affine_displacement(mesh.points, turn(1)) + random_displacement(mesh.vertex_count(), 2e-3);
  const Mat3X<double> f = forces<double>(setup, u);
  const EnergyAndForces exact = energy_and_forces(elements, u);
  CHECK((exact.forces - f).norm() < 1e-12 * f.norm());
  CHECK(exact.energy == near(elastic_energy(setup, u), 1e-13));
  CHECK(exact.smallest_volume_ratio < 1);
  CorotationalRegion<double> region;
  RegionEdit edit;
  for (Index t = 0; t < mesh.tet_count(); ++t) edit.entered.push_back(t);
  for (Index v = 0; v < mesh.vertex_count(); ++v) edit.vertices.push_back(v);
  region.follow(elements, edit);
  CHECK(region.tet_count() == mesh.tet_count());
  DiagonalStiffness K = DiagonalStiffness::Zero(6, mesh.vertex_count()), corners = K;
  Parallel one_thread;
  const SmallestVolumeRatio smallest = region.add_diagonal_stiffness(u, K, one_thread);
  CHECK(smallest.smallest_volume_ratio == near(exact.smallest_volume_ratio, 1e-13));
  CHECK(smallest.smallest_tet == exact.smallest_tet);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> at_corners = u(Eigen::all, mesh.tets.col(t));
    const CornerStiffness of_tet = corner_stiffness(elements, t, at_corners);
    const TetStiffness whole = tet_stiffness(elements, t, at_corners, corotational, 0);
    for (int c = 0; c < 4; ++c) {
      corners.col(mesh.tets(c, t)) += of_tet.col(c);
      CHECK(whole(3 * c, 3 * c) == near(of_tet(0, c), 1e-12));
    }
    const Shape s = elements.shape_of(t);
    const Mat3<double> H = displacement_gradient<double>(at_corners, s.gradients.rightCols<3>()),
                       F = Mat3<double>::Identity() + H;
    const Mat3<double> cauchy =
        law_stress<double>(corotational_law(seed_material), H) * F.transpose() / F.determinant();
    CHECK((tet_fields(elements, t, at_corners, 0).stress - cauchy).norm() < 1e-13 * cauchy.norm());
  }
  CHECK((corners - K).norm() < 1e-13 * K.norm());
}

// Strains are up to 13 % at its faces. A linear bar cannot bend like that.
TEST_CASE("a bar bent by 90 degrees is where a non-linear one is, which no linear one is") {
  for (const bool is_smoothed : {false, true}) {
    const StaticResult exact = bent(RegionModel::nonlinear, is_smoothed),
                       found = bent(corotational, is_smoothed),
                       linear = bent(RegionModel::tensor_mass, is_smoothed);
    const double largest = exact.u.colwise().norm().maxCoeff();
    const auto error = [&](const StaticResult& result) {
      return (result.u - exact.u).colwise().norm().maxCoeff() / largest;
    };
    CHECK(error(found) < 0.02);
    CHECK(error(linear) > 0.2);
    CHECK(found.energy == near(exact.energy, 0.02));
  }
}

TEST_CASE("a turning bar keeps its energy but for what is of second order in the step") {
  const auto drift = [](double share) {
    Setup setup = bar(corotational);
    setup.prescribed.clear();
    setup.damping = 0;
    World<double> world(setup);
    State<double> state = world.state();
    const Vec3d centre(0.06, 0.01, 0.01);
    for (Index v = 0; v < state.v.cols(); ++v)
      state.v.col(v) = Vec3d(0, 5, 20).cross(Vec3d(setup.mesh.points.col(v) - centre));
    world.set_state(state);
    const double dt = share * world.time_step_limit();
    return energy_drift(world, dt, int(400 / share));  // a turn and a half
  };
  const double coarse = drift(0.2), fine = drift(0.1);
  CHECK(coarse < 1e-3);
  CHECK(fine < coarse / 3.5);
}

TEST_CASE("an inverted body comes back to rest") {
  Setup setup = setup_of(irregular_box(2), corotational);
  setup.damping = 100;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) < 0.004) setup.prescribed.push_back({v, Vec3d::Zero()});
  World<float> world(setup);
  State<float> state = world.state();
  for (Index v = 0; v < state.u.cols(); ++v)  // pushed through the wall that it is held at
    state.u(0, v) = float(-1.7 * std::max(0.0, setup.mesh.points(0, v)));
  for (const HeldVertices::Held& item : world.held().all()) state.u.col(item.vertex).setZero();
  world.set_state(state);
  CHECK(world.advance(1e-4).ok);
  for (int i = 0; i < 40; ++i) CHECK(world.advance(0.05).ok);
  CHECK(world.state().u.norm() < 1e-4 * state.u.norm());
}

TEST_CASE("one, two and seven threads give the same bits") {
  const TetMesh mesh = irregular_box(12);
  const Mat3X<float> u = random_displacement<float>(mesh.vertex_count(), 2e-3);
  for (const Setup& setup : of_both_elements(half_corotational(mesh, RegionModel::nonlinear))) {
    CHECK(forces<float>(setup, u, 1) == forces<float>(setup, u, 2));
    CHECK(forces<float>(setup, u, 1) == forces<float>(setup, u, 7));
  }
}

TEST_CASE("after cuts and changes of regions it is the model built with what is left") {
  const TetMesh mesh = irregular_box(4);
  std::vector<Index> cut, moved, taken;
  for (Index t = 0; t < mesh.tet_count(); ++t) (t % 7 == 0 ? cut : t % 3 == 0 ? moved : taken).push_back(t);
  for (const Setup& setup : of_both_elements(half_corotational(mesh, RegionModel::nonlinear))) {
    World<double> world(setup);
    State<double> state = world.state();
    state.u = affine_displacement(mesh.points, turn(0.4)) + random_displacement(mesh.vertex_count(), 1e-3);
    world.set_state(state);
    for (int round = 0; round < 3; ++round) {
      if (round == 0) world.remove_tets(cut);
      if (round == 1) world.apply(SetRegion{moved, corotational});
      if (round == 2) world.apply(SetRegion{taken, RegionModel::tensor_mass});
      CHECK(fault_of(world) == "");
      CHECK(compare_with_rebuilt(world).largest() < 1e-11);
    }
  }
}

TEST_CASE("what no corotational region can have is refused by name") {
  Setup setup = setup_of(irregular_box(2), corotational);
  const auto refusal = [](const Setup& bad) -> std::string {
    try {
      World<double> world(bad);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(refusal(setup).empty());
  setup.materials[0].fibre = {1e3, 1e3, 1e4};
  setup.mesh.fibres = Vec3d(1, 0, 0).replicate(1, setup.mesh.tet_count());
  CHECK(refusal(setup).find("\"model\": \"corotational\" does not go with a material with fibres") !=
        std::string::npos);
}
