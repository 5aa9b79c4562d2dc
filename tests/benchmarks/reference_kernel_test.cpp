#include "benchmarks/reference_kernel.h"

#include <doctest/doctest.h>

#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::bench;
using namespace lobe::test;

namespace {

Mat3X<double> world_forces(const Setup& setup, const Mat3X<double>& u) {
  World<double> world(setup);
  State<double> state = world.state();
  state.u = u;
  world.set_state(state);
  return world.forces();
}

double relative(const Mat3X<double>& f, const Mat3X<double>& expected) {
  return (f - expected).norm() / expected.norm();
}

}  // namespace

TEST_CASE("the reference kernel's forces are those of a World, on two materials") {
  Setup setup = setup_of(irregular_box(4));
  setup.materials.push_back({7e4, 2e4, 1100});
  for (std::size_t t = 0; t < setup.material_of.size(); t += 3) setup.material_of[t] = 1;
  const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 2e-3);
  const std::vector<ReferenceTet> tets = reference_tets(setup);

  Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
  add_reference_forces(tets, u, f);
  CHECK(relative(f, world_forces(setup, u)) < 1e-12);

  setup.volume_penalty = 1e5;
  add_reference_volume_forces(tets, setup.mesh.points + u, setup.volume_penalty, f);
  CHECK(relative(f, world_forces(setup, u)) < 1e-12);

  setup.region_of.assign(setup.region_of.size(), RegionModel::tensor_mass);
  Mat3X<double> linear = Mat3X<double>::Zero(3, u.cols());
  add_reference_linear_forces(tets, u, linear);
  CHECK(relative(linear, world_forces(setup, u)) < 1e-12);
  CHECK(relative(linear, f) > 0.01);  // the displacement is large enough to tell them apart
}

TEST_CASE("the reference's nodal pressure is that of a World") {
  const Setup setup = setup_of(irregular_box(4));
  const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 2e-3);
  Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
  add_reference_nodal_pressure_forces(reference_tets(setup), u, f);
  CHECK(relative(f, world_forces(averaged(setup), u)) < 1e-12);
  CHECK(relative(f, world_forces(setup, u)) > 0.01);  // the displacement is large enough to tell them apart
}

TEST_CASE("the reference's smoothed edges are those of a World, alone and with nodal pressure") {
  const Setup setup = setup_of(irregular_box(4));
  const Mat3X<double> u = random_displacement(setup.mesh.vertex_count(), 2e-3);
  for (double share : {0.0, 1.0}) {
    Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
    add_reference_smoothed_forces(reference_tets(setup), u, share > 0, f);
    CHECK(relative(f, world_forces(smoothed(averaged(setup, share)), u)) < 1e-12);
    CHECK(relative(f, world_forces(averaged(setup, share), u)) > 0.01);
  }
}

TEST_CASE("the reference kernel's masses add up to density times volume") {
  const Setup setup = setup_of(irregular_box());
  double mass = 0;
  for (const ReferenceTet& tet : reference_tets(setup)) mass += 4 * tet.corner_mass;
  CHECK(mass == near(1000 * total_volume(setup.mesh), 1e-13));
}
