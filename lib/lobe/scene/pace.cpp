#include "lobe/scene/pace.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "lobe/setup/exclusions.h"
#include "lobe/sim/world.h"

namespace lobe {
namespace {

constexpr int steps_of_frame = 64;  // where all step together: twice the longest large step

// The setup without tools, loads and contact, by own steps.
Setup bare(const Setup& setup) {
  Setup bare;
  static_cast<Body&>(bare) = setup;
  bare.prescribed = setup.prescribed;
  bare.partly_held = setup.partly_held;
  bare.attachments = setup.attachments;
  bare.safety = setup.safety;
  bare.own_steps = true;
  return bare;
}

// Tensor-mass regions are evaluated by edges, which have no material.
std::vector<Level> highest_of_materials(const Setup& setup, Dynamics<double>& body) {
  const std::vector<Level>& levels = body.own_steps->levels();
  std::vector<Level> highest(setup.materials.size(), 0);
  Level of_edges = 0;
  std::size_t at = 0;
  body.regions.visit_patches([&]<class Layout>(const Layout& layout, const auto&) {
    for (Index p = 0; p < layout.patch_count(); ++p, ++at) {
      if (layout.patch(p).items == 0) continue;
      Level& most = std::is_same_v<Layout, PatchLayout<2>> ? of_edges : highest[layout.patch(p).kind];
      most = std::max(most, levels[at]);
    }
  });
  for (std::size_t t = 0; t < setup.region_of.size(); ++t)
    if (setup.region_of[t] == RegionModel::tensor_mass) {
      Level& most = highest[setup.material_of[t]];
      most = std::max(most, of_edges);
    }
  return highest;
}

}  // namespace

std::optional<Pace> pace_at_rest(const Setup& setup) {
  if (!goes_with(Option::own_steps, options_of(setup))) return std::nullopt;
  World<double> world(bare(setup));
  const double limit = world.time_step_limit();
  if (!std::isfinite(limit)) return std::nullopt;
  const Report report = world.advance(steps_of_frame * setup.safety * limit);
  const OwnSteps<double>& own_steps = *world.body().own_steps;
  if (!own_steps.any()) return std::nullopt;
  return Pace{limit, highest_of_materials(setup, world.body()),
              report.steps * own_steps.share() / steps_of_frame};
}

}  // namespace lobe
