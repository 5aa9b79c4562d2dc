#include "lobe/scene/listed_regions.h"

#include <algorithm>

namespace lobe {
namespace {

// What all regions of one model have in common.
struct RegionOptions {
  RegionFrame frame = RegionFrame::fixed;  // precomputed
  double cell = 0, tolerance = 0;          // reduced
};

// A region for each model that some tetrahedron has. Non-linear ones are what is left.
std::vector<Region> listed(const std::vector<RegionModel>& region_of, const RegionOptions& options) {
  std::vector<Region> regions;
  for (std::size_t i = 0; i < region_model_names.size(); ++i) {
    const auto model = RegionModel(i);
    if (model == Region{}.model) continue;
    SelectTetrahedra selected;
    for (std::size_t t = 0; t < region_of.size(); ++t)
      if (region_of[t] == model) selected.tetrahedra.push_back(static_cast<Index>(t));
    if (selected.tetrahedra.empty()) continue;
    Region& region = regions.emplace_back();
    region.name = name(model);
    region.model = model;
    region.where = Selector{std::move(selected)};
    if (model == RegionModel::precomputed) region.frame = options.frame;
    if (model == RegionModel::reduced) {
      region.cell = options.cell;
      region.tolerance = options.tolerance;
    }
  }
  return regions;
}

}  // namespace

void list_regions(const std::vector<RegionModel>& region_of, Scene& scene) {
  RegionOptions options{.tolerance = scene.reduced_tolerance().value_or(0)};
  for (const Region& region : scene.regions) {
    if (region.model == RegionModel::precomputed) options.frame = region.frame;
    if (region.model == RegionModel::reduced) options.cell = region.cell;
  }
  scene.regions = listed(region_of, options);
  scene.auto_regions.reset();
}

void state_regions(const Setup& setup, Scene& scene) {
  const auto is_precomputed = [](const Region& region) { return region.model == RegionModel::precomputed; };
  if (!scene.auto_regions && std::none_of(scene.regions.begin(), scene.regions.end(), is_precomputed)) return;
  scene.regions = listed(
      setup.region_of, {setup.precomputed_frame, setup.lattice_cell, scene.reduced_tolerance().value_or(0)});
  scene.auto_regions.reset();
  scene.time.selective_mass = setup.selective_mass;  // automatic reduced regions go without
}

}  // namespace lobe
