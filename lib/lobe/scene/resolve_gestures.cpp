#include "lobe/scene/resolve_parts.h"

namespace lobe {

void resolve_gestures(Resolution& resolution) {
  if (!resolution.scene.auto_regions) return;
  if (resolution.scene.time.integrator == Integrator::generalised_alpha)
    resolution.fail("/regions/auto",
                    "needs \"integrator\": \"explicit\"; an implicit step gains nothing from linear regions");
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

void propose(const Scene& scene, Resolved& resolved, const SparseFactorMaker& factor,
             const std::function<void(double fraction)>& progress) {
  if (!scene.auto_regions) return;
  ProposalOptions options;
  options.tolerance = scene.auto_regions->tolerance;
  options.condense = scene.auto_regions->precomputed;
  options.in_double = scene.in_double();
  options.factor = factor;
  options.progress = progress;
  resolved.proposal = propose_regions(resolved.setup, resolved.gestures, options);
  resolved.setup.region_of = resolved.proposal->region_of;
  for (const std::string& note : resolved.proposal->notes)
    resolved.warnings.push_back("/regions/auto: " + note);
}

}  // namespace lobe
