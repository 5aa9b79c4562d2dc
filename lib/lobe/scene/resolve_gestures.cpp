#include <algorithm>

#include "lobe/lattice/lattice.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/resolve_parts.h"
#include "lobe/setup/exclusions.h"

namespace lobe {

void resolve_gestures(Resolution& resolution) {
  if (!resolution.scene.auto_regions) return;
  std::vector<Gesture>& gestures = resolution.result.gestures;
  for (const SceneGesture& entry : resolution.scene.auto_regions->gestures) {
    const std::string place = entry.pointer + "/where";
    const std::size_t before = resolution.faults.size();
    Gesture gesture{
        entry.name,
        resolution.selected([&] { return select_vertices(entry.where, resolution.mesh(), place); }),
        {},
        Vec3d::Zero()};
    if (gesture.vertices.empty() && resolution.faults.size() == before)
      resolution.fail_empty(place, "vertex");
    if (entry.is_force)
      gesture.force = entry.value;
    else
      gesture.displacements.assign(gesture.vertices.size(), entry.value);
    gestures.push_back(std::move(gesture));
  }
  if (gestures.empty()) gestures = gestures_of_grasps(resolution.result.setup);
}

namespace {

double largest_poisson_ratio(const Setup& setup) {
  double largest = -1;
  for (const std::uint16_t m : setup.material_of)
    largest = std::max(largest, poisson_ratio(setup.materials[m].lambda, setup.materials[m].mu));
  return largest;
}

// Makes all of a body one reduced region, if it may be one and its mesh is fine enough for that to pay.
bool reduce_automatic(Resolution& resolution) {
  constexpr double pays_above = 60;  // tetrahedra in the volume of a cell
  Resolved& resolved = resolution.result;
  const auto leave = [&](const std::string& why) {
    resolution.warn("/regions/auto/reduced", "nothing is reduced: " + why);
    return false;
  };
  const double nu = largest_poisson_ratio(resolved.setup);
  if (nu > locks_above)
    return leave("Poisson's ratio is " + rounded(nu) + ", and above " + rounded(locks_above) +
                 " linear tetrahedra lock; use \"nonlinear\" with \"nodal_pressure\": true");
  Setup trial = resolved.setup;
  trial.region_of.assign(trial.region_of.size(), RegionModel::reduced);
  trial.selective_mass = 1;
  try {
    refuse_excluded(option_of(RegionModel::reduced), options_of(trial), "");
    const Elements elements(trial);
    const double edge = choose_lattice(elements, 0).edge,
                 in_a_cell = double(trial.region_of.size()) * edge * edge * edge / total_volume(trial.mesh);
    if (in_a_cell < pays_above)
      return leave("a cell of the lattice has the volume of " + rounded(in_a_cell) +
                   " tetrahedra, and it pays above " + rounded(pays_above));
  } catch (const InputError& error) {
    return leave(error.faults().front().message);
  }
  if (resolved.setup.selective_mass > 1)
    resolution.warn("/time/selective_mass", "is not used: all is reduced, which pays more");
  resolved.setup.region_of = trial.region_of;
  resolved.setup.selective_mass = 1;
  resolved.proposal.emplace().region_of = trial.region_of;
  return true;
}

void propose_automatic(Resolution& resolution, const std::function<void(double fraction)>& progress) {
  const Scene& scene = resolution.scene;
  Resolved& resolved = resolution.result;
  if (scene.auto_regions->reduced && reduce_automatic(resolution)) return;
  ProposalOptions options;
  options.tolerance = scene.auto_regions->tolerance;
  options.condense = scene.auto_regions->precomputed;
  options.in_double = scene.in_double();
  options.progress = progress;
  std::vector<RegionModel>& region_of = resolved.setup.region_of;
  if (scene.corrects_masses()) {
    std::fill(region_of.begin(), region_of.end(), RegionModel::nonlinear);
    resolution.warn("/regions/auto",
                    "nothing is linear: time/selective_mass takes its place, and is corrected");
    resolved.proposal.emplace().region_of = region_of;
    return;
  }
  if (scene.auto_regions->correct) {
    resolved.proposal = propose_regions_to_correct(resolved.setup, resolved.gestures, options);
    region_of = resolved.proposal->region_of;
    resolved.setup.expandable = std::count(region_of.begin(), region_of.end(), RegionModel::precomputed) > 0;
  } else {
    resolved.proposal = propose_regions(resolved.setup, resolved.gestures, options);
    region_of = resolved.proposal->region_of;
  }
  for (const std::string& note : resolved.proposal->notes) resolution.warn("/regions/auto", note);
}

}  // namespace

void choose_regions(Resolution& resolution, const std::function<void(double fraction)>& progress) {
  if (resolution.scene.auto_regions) propose_automatic(resolution, progress);
}

}  // namespace lobe
