#include <filesystem>
#include <optional>
#include <utility>

#include "golden/golden.h"
#include "lobe/linearity/mass_watch.h"
#include "lobe/linearity/watch.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"

namespace lobe::test {
namespace {

// In place of what is measured: the regions are the same on every machine.
constexpr StepCost fixed_cost{.nonlinear = 2.5e-8, .tensor_mass = 1.2e-8, .shared = 2e-8, .dense = 1.5e-10};

void choose_regions(const Scene& scene, Resolved& resolved) {
  ProposalOptions options;
  options.tolerance = scene.auto_regions->tolerance;
  options.cost = fixed_cost;
  const Proposal proposal = propose_regions_to_correct(resolved.setup, resolved.gestures, options);
  resolved.setup.region_of = proposal.region_of;
  resolved.setup.expandable = true;
}

// A scene with the regions that are chosen for it, made when it is first asked for: no thread takes part.
class ReadyScene {
 public:
  const std::pair<Scene, Resolved>& of(const std::string& name) {
    if (!made_) {
      Scene scene = read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / (name + ".json"));
      Resolved resolved = resolve(scene, read_scene_mesh(scene).mesh, {false});
      if (scene.auto_regions) choose_regions(scene, resolved);
      made_.emplace(std::move(scene), std::move(resolved));
    }
    return *made_;
  }

 private:
  std::optional<std::pair<Scene, Resolved>> made_;
};

template <class Real>
Digests play_scene(const Scene& scene, const Resolved& resolved, int threads) {
  const int frames = std::max(1, static_cast<int>(std::lround(scene.time.duration / scene.time.frame)));
  return play_golden<Real>(resolved.setup, threads, frames, scene.time.duration / frames,
                           [&](World<Real>& world) {
                             std::vector<std::vector<Index>> grasps;
                             for (const GraspSetup& grasp : resolved.setup.grasps)
                               grasps.push_back(grasp.vertices);
                             std::shared_ptr<LinearityWatch<Real>> watch;
                             if (scene.auto_regions)
                               watch = std::make_shared<LinearityWatch<Real>>(
                                   world, grasps, LinearityOptions{scene.auto_regions->tolerance, true});
                             return [watch, &world](int) {
                               if (watch) watch->look(world);
                             };
                           });
}

}  // namespace

std::vector<GoldenRun> shipped_scenes() {
  std::vector<GoldenRun> runs;
  for (const std::string name : {"accuracy_beam", "accuracy_cylinder", "accuracy_liver", "liver_resection",
                                 "liver_declared", "liver_undeclared", "liver_palpation", "liver_pick_up",
                                 "liver_fallen", "liver_incision", "accuracy_undeclared", "kidney_undeclared",
                                 "liver_crossing", "liver_hands", "liver_scalpel", "two_organs", "ventricle"})
    runs.push_back({name, [ready = ReadyScene(), name](int threads) mutable {
                      const auto& [scene, resolved] = ready.of(name);
                      return play_scene<float>(scene, resolved, threads);
                    }});
  return runs;
}

}  // namespace lobe::test
