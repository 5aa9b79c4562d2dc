#include "lobe/live/session_scene.h"

#include <algorithm>
#include <type_traits>

#include "lobe/error.h"
#include "lobe/scene/listed_regions.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/tool_kinds.h"
#include "lobe/setup/exclusions.h"
#include "lobe/text.h"

namespace lobe {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw InputError("session", why); }

// The name of an edit that a scene cannot describe.
const char* edit_name(const Command& command) {
  if (std::holds_alternative<RemoveTets>(command)) return "tetrahedra were removed";
  if (std::holds_alternative<SetRegion>(command)) return "a region was changed";
  if (std::holds_alternative<SetMassDegree>(command)) return "the degree of the masses was changed";
  if (std::holds_alternative<KeepFull>(command)) return "vertices of a reduced region were kept full";
  if (std::holds_alternative<SetForces>(command)) return "forces were set";
  if (std::holds_alternative<SetSprings>(command) || std::holds_alternative<MoveSprings>(command))
    return "springs were set";
  if (std::holds_alternative<BringThread>(command)) return "a thread was brought";
  if (std::holds_alternative<Pull>(command) || std::holds_alternative<Tie>(command) ||
      std::holds_alternative<CutThread>(command) || std::holds_alternative<Bite>(command))
    return "a thread was drawn, pulled, tied or cut";
  if (std::holds_alternative<Attach>(command) || std::holds_alternative<Detach>(command))
    return "something was attached or detached";
  if (std::holds_alternative<Expand>(command) || std::holds_alternative<Condense>(command) ||
      std::holds_alternative<Relinearise>(command))
    return "a precomputed region was expanded, condensed or relinearised";
  return nullptr;
}

// The number of frames up to now, all of the same length.
template <class Real>
int frames_of(const Session<Real>& session) {
  int frames = 0;
  visit_to_the_end(session.recording(), [&](const Command& command, std::size_t times) {
    const std::string at = " at " + rounded(frames * session.frame()) + " s";
    if (const char* edit = edit_name(command))
      refuse(edit + at + ", which a scene cannot describe; a recording can");
    if (std::holds_alternative<Advance>(command)) frames += int(times);
  });
  if (frames == 0) refuse("nothing was simulated yet");
  if (frames * session.frame() != session.world().time())
    refuse("a frame failed, after which no scene gets here; go back to before it");
  return frames;
}

}  // namespace

Setup session_setup(const Scene& scene, Setup setup) {
  if (!scene.time.sleep && goes_with(Option::sleep, options_of(setup))) {
    const Box box = bounding_box(setup.mesh);
    setup.sleep = session_sleep * (box.max - box.min).norm();
  }
  return setup;
}

template <class Real>
Scene session_scene(const Scene& scene, const Setup& setup, const Session<Real>& session) {
  if (session.world().journal().setup != fingerprint(setup))
    refuse("is of another scene, mesh or version of them");
  if (scene.in_double() != std::is_same_v<Real, double>)
    refuse(scene.in_double() ? "is in single precision, its scene in double"
                             : "is in double precision, its scene in single");
  const int frames = frames_of(session);
  Scene kept = with_absolute_paths(scene);
  kept.time.frame = session.frame();
  kept.time.duration = frames * session.frame();
  std::erase_if(kept.output.pictures, [&](double time) { return time > kept.time.duration; });
  if (setup.sleep > 0) kept.time.sleep = setup.sleep;
  state_regions(setup, kept);  // another measurement might choose other ones
  append_tools(session.world().tools().live_paths(), setup.mesh.vertex_count(), kept.tools);
  return kept;
}

Scene with_gestures(Scene scene, double tolerance) {
  AutoRegions regions;
  regions.tolerance = tolerance;
  for (const Tool& tool : scene.tools) {
    if (!tool.is<GraspSetup>()) continue;
    const SceneGrasp& grasp = tool.as<GraspSetup>();
    const auto furthest = std::max_element(
        grasp.path.begin(), grasp.path.end(),
        [](const PathPoint& a, const PathPoint& b) { return a.position.norm() < b.position.norm(); });
    const bool holds_copies_alone =
        !grasp.copies.empty() && std::holds_alternative<SelectNot>(grasp.where->value);
    if (!holds_copies_alone && !furthest->position.isZero(0))
      regions.gestures.push_back({grasp.name, *grasp.where, false, furthest->position, ""});
  }
  scene.regions.clear();
  scene.auto_regions = regions;
  return scene;
}

template Scene session_scene(const Scene&, const Setup&, const Session<float>&);
template Scene session_scene(const Scene&, const Setup&, const Session<double>&);

}  // namespace lobe
