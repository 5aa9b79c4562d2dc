#include "lobe/instruction_set.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <numeric>

#include "fibre_support.h"
#include "lobe/error.h"
#include "lobe/region/corotational.h"
#include "lobe/region/nonlinear.h"
#include "lobe/region/tensor_mass.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class Real, class Region>
Mat3X<Real> forces_in(const Setup& setup, Region region) {
  const Elements elements(setup);
  RegionEdit edit;
  edit.entered.resize(std::size_t(setup.mesh.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  edit.vertices.resize(std::size_t(setup.mesh.vertex_count()));
  std::iota(edit.vertices.begin(), edit.vertices.end(), 0);
  region.follow(elements, edit);
  const Mat3X<Real> u = random_displacement<Real>(setup.mesh.vertex_count(), 2e-3);
  Mat3X<Real> f = Mat3X<Real>::Zero(3, u.cols());
  Parallel one_thread;
  region.add_forces(u, f, one_thread);
  return f;
}

// region(set) makes one that runs on a set of instructions.
template <class Real, class Make>
void check_same_bits(const Setup& setup, Make&& region) {
  const Mat3X<Real> expected = forces_in<Real>(setup, region(InstructionSet::baseline));
  CHECK(expected.norm() > 0);
  for (InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    CHECK((forces_in<Real>(setup, region(set)).array() == expected.array()).all());
  }
}

template <class Real>
void check_nonlinear(const Setup& setup) {
  check_same_bits<Real>(setup, [](InstructionSet set) { return NonlinearRegion<Real>(set); });
}

}  // namespace

TEST_CASE(
    "every instruction set gives the same bits, with and without volume term, guard and nodal pressure") {
  Setup setup = setup_of(irregular_box(3));
  for (const auto& [kappa, below] : {std::pair{0.0, 0.0}, {0.0, 0.8}, {1e5, 0.0}, {1e5, 0.8}}) {
    setup.volume_penalty = kappa;
    setup.guard_below = below;
    check_nonlinear<float>(setup);
    check_nonlinear<double>(setup);
    check_nonlinear<float>(averaged(setup));
    check_nonlinear<double>(averaged(setup));
  }
}

TEST_CASE_TEMPLATE("every instruction set gives the same bits with tensor-mass and corotational", Real, float,
                   double) {
  const TetMesh mesh = irregular_box(4);
  Setup fibrous = smoothed(setup_of(mesh, RegionModel::tensor_mass));
  fibrous.materials[0].fibre = {3e3, 8e3, 5e4};
  fibrous.mesh.fibres = random_displacement(mesh.tet_count(), 1).colwise().normalized();
  for (const Setup& setup : {setup_of(mesh, RegionModel::tensor_mass),
                             smoothed(setup_of(mesh, RegionModel::tensor_mass)), fibrous})
    check_same_bits<Real>(setup, [](InstructionSet set) { return TensorMassRegion<Real>(set); });
  const Setup corotational = setup_of(mesh, RegionModel::corotational);
  for (const Setup& setup : {corotational, smoothed(corotational)})
    check_same_bits<Real>(setup, [](InstructionSet set) { return CorotationalRegion<Real>(set); });
}

TEST_CASE("every instruction set gives the same bits with fibres and of every other law") {
  Setup fibrous = setup_of(irregular_box(3)), neo = fibrous, yeoh = yeoh_setup(irregular_box(3));
  fibrous.materials[0].fibre = {3e3, 8e3, 5e4};
  fibrous.mesh.fibres = random_displacement(fibrous.mesh.tet_count(), 1).colwise().normalized();
  neo.materials[0].law = MaterialLaw::neo_hookean;
  const Setup mooney = mooney_rivlin_setup(irregular_box(3)), holzapfel = holzapfel_setup(irregular_box(3));
  for (const auto& [kappa, below] : {std::pair{0.0, 0.0}, {0.0, 0.8}, {1e5, 0.0}, {1e5, 0.8}}) {
    for (Setup setup :
         {fibrous, neo, yeoh, mooney, holzapfel, averaged(fibrous), averaged(neo), averaged(holzapfel)}) {
      setup.volume_penalty = kappa;
      setup.guard_below = below;
      check_nonlinear<float>(setup);
      check_nonlinear<double>(setup);
    }
  }
}

TEST_CASE(
    "every instruction set gives the same bits of smoothed edges, of every law and with nodal pressure") {
  Setup setup = smoothed(setup_of(irregular_box(3))), fibrous = setup, neo = setup,
        yeoh = smoothed(yeoh_setup(irregular_box(3)));
  fibrous.materials[0].fibre = {3e3, 8e3, 5e4};
  fibrous.mesh.fibres = random_displacement(fibrous.mesh.tet_count(), 1).colwise().normalized();
  neo.materials[0].law = MaterialLaw::neo_hookean;
  setup.volume_penalty = 1e5;
  Setup guarded = setup;
  guarded.guard_below = 0.8;
  const Setup mooney = smoothed(mooney_rivlin_setup(irregular_box(3))),
              holzapfel = smoothed(holzapfel_setup(irregular_box(3)));
  for (const Setup& each : {setup, guarded, fibrous, neo, yeoh, mooney, holzapfel, averaged(setup),
                            averaged(fibrous), averaged(neo), averaged(holzapfel)}) {
    check_nonlinear<float>(each);
    check_nonlinear<double>(each);
  }
}

TEST_CASE("LOBE_INSTRUCTION_SET chooses the set, and what the processor does not have is refused") {
  REQUIRE(std::getenv("LOBE_INSTRUCTION_SET") == nullptr);
  CHECK(chosen_instruction_set() == available_instruction_sets().back());
  setenv("LOBE_INSTRUCTION_SET", "baseline", 1);
  CHECK(chosen_instruction_set() == InstructionSet::baseline);
  setenv("LOBE_INSTRUCTION_SET", "avx3", 1);
  CHECK_THROWS_AS(chosen_instruction_set(), InputError);
  unsetenv("LOBE_INSTRUCTION_SET");
}
