#include "lobe/instruction_set.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <numeric>

#include "lobe/error.h"
#include "lobe/region/nonlinear.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class Real>
Mat3X<Real> forces(const Setup& setup, InstructionSet set) {
  const Elements elements(setup);
  RegionEdit edit;
  edit.entered.resize(std::size_t(setup.mesh.tet_count()));
  std::iota(edit.entered.begin(), edit.entered.end(), 0);
  NonlinearRegion<Real> region(Evaluator::direct, set);
  region.follow(elements, edit);
  const Mat3X<Real> u = random_displacement<Real>(setup.mesh.vertex_count(), 2e-3);
  Mat3X<Real> f = Mat3X<Real>::Zero(3, u.cols());
  Parallel one_thread;
  region.add_forces(u, f, one_thread);
  return f;
}

template <class Real>
void check_same_bits(const Setup& setup) {
  const Mat3X<Real> expected = forces<Real>(setup, InstructionSet::baseline);
  CHECK(expected.norm() > 0);
  for (InstructionSet set : available_instruction_sets()) {
    CAPTURE(name(set));
    CHECK((forces<Real>(setup, set).array() == expected.array()).all());
  }
}

}  // namespace

TEST_CASE(
    "every instruction set gives the same bits, with and without volume term, guard and nodal pressure") {
  Setup setup = setup_of(irregular_box(3));
  for (const auto& [kappa, below] : {std::pair{0.0, 0.0}, {0.0, 0.8}, {1e5, 0.0}, {1e5, 0.8}}) {
    setup.volume_penalty = kappa;
    setup.guard_below = below;
    check_same_bits<float>(setup);
    check_same_bits<double>(setup);
    check_same_bits<float>(averaged(setup));
    check_same_bits<double>(averaged(setup));
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
