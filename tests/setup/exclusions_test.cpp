#include "lobe/setup/exclusions.h"

#include <doctest/doctest.h>

#include <memory>

#include "lobe/sim/world.h"
#include "lobe/solve/static_solver.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// A setup that asks for an option; what a setup cannot say stays as it is.
void ask_for(Setup& setup, Option option) {
  const auto make_half = [&](RegionModel model) {
    std::fill_n(setup.region_of.begin(), setup.region_of.size() / 2, model);
  };
  if (std::size_t(option) < region_model_names.size()) return make_half(RegionModel(option));
  switch (option) {
    case Option::corotated:
      setup.precomputed_frame = RegionFrame::corotated;
      make_half(RegionModel::precomputed);
      break;
    case Option::expandable:
      setup.expandable = true;
      break;
    case Option::fibres:
      setup.materials.push_back(Elastic{});
      setup.materials.back().fibre.stretch = 1e3;
      setup.material_of.back() = static_cast<std::uint16_t>(setup.materials.size() - 1);
      setup.mesh.fibres = Vec3d::UnitZ().replicate(1, setup.mesh.tet_count());
      break;
    case Option::nodal_pressure:
      setup.materials[0].nodal_pressure = 1;
      break;
    case Option::edge_smoothed:
      setup.materials[0].element = ElementType::edge_smoothed;
      break;
    case Option::other_law:
      setup.materials[0].law = MaterialLaw::neo_hookean;
      break;
    case Option::viscous:
      setup.materials[0].viscosity = {PronyTerm{0.3, 0, 0.1}};
      break;
    case Option::sleep:
      setup.sleep = 1e-5;
      break;
    case Option::own_steps:
      setup.own_steps = true;
      break;
    case Option::selective_mass:
      setup.selective_mass = 5;
      break;
    case Option::partly_held:
      setup.partly_held.push_back({0, 0.5});
      break;
    case Option::implicit:
      setup.integrator = Integrator::generalised_alpha;
      break;
    case Option::automatic:
    case Option::force_terms:
    case Option::single_precision:
    case Option::static_solution:
      break;
  }
}

// Why it is refused; empty: it is not.
std::string fault_of(Option a, Option b) {
  Setup setup = setup_of(irregular_box(3));
  setup.damping = 1;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.prescribed.push_back({v, Vec3d::Zero()});
  ask_for(setup, a);
  ask_for(setup, b);
  const auto asks = [&](Option option) { return a == option || b == option; };
  try {
    if (asks(Option::static_solution)) {
      solve_static(setup);
    } else if (asks(Option::single_precision)) {
      World<float>{setup};
    } else {
      World<double> world(setup);
      if (asks(Option::force_terms)) world.apply(SetSprings{{{0, 1.0, Vec3d::Zero()}}});
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool is_excluded(Option a, Option b) {
  constexpr Option precomputed = option_of(RegionModel::precomputed);
  if (a == Option::corotated && is_excluded(precomputed, b)) return true;  // it is of such a region
  if (b == Option::corotated && is_excluded(a, precomputed)) return true;
  for (const Exclusion& exclusion : exclusions())
    if ((exclusion.option == a && exclusion.other == b) || (exclusion.option == b && exclusion.other == a))
      return true;
  return false;
}

}  // namespace

TEST_CASE("each pair of options is refused by name if the table has it, and accepted if not") {
  for (std::size_t i = 0; i < option_count; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Option a{static_cast<std::uint8_t>(i)}, b{static_cast<std::uint8_t>(j)};
      if (a == Option::automatic || b == Option::automatic) continue;  // of scenes: tests/scene
      CAPTURE(name(a));
      CAPTURE(name(b));
      const std::string fault = fault_of(a, b);
      CHECK(fault.empty() != is_excluded(a, b));
      if (!fault.empty()) CHECK(fault.find(" does not go with ") != std::string::npos);
    }
}

TEST_CASE("options of one material are refused together by name, and accepted in two materials") {
  for (const Exclusion& exclusion : material_exclusions()) {
    CAPTURE(name(exclusion.option));
    CAPTURE(name(exclusion.other));
    CHECK(fault_of(exclusion.option, exclusion.other).empty());
    Setup setup = setup_of(irregular_box(3));
    ask_for(setup, exclusion.option);
    ask_for(setup, exclusion.other);
    REQUIRE(setup.materials.size() == 2);
    setup.materials[1].law = setup.materials[0].law;
    const std::string fault = name(exclusion.option) + " does not go with " + name(exclusion.other);
    CHECK_THROWS_WITH_AS(World<double>{setup}, doctest::Contains(fault.c_str()), InputError);
  }
}

TEST_CASE("a running world refuses what its setup excludes, and has then changed nothing") {
  Setup setup = setup_of(irregular_box(3));
  setup.selective_mass = 5;
  for (Index v = 0; v < setup.mesh.vertex_count(); ++v) setup.prescribed.push_back({v, Vec3d::Zero()});
  World<double> world(setup);
  CHECK_THROWS_WITH_AS(world.apply(SetRegion{{0, 1}, RegionModel::reduced}),
                       doctest::Contains("\"model\": \"reduced\" does not go with \"selective_mass\""),
                       InputError);
  CHECK(world.elements().region_of[0] == RegionModel::nonlinear);
  CHECK(world.journal().edits.empty());
}
