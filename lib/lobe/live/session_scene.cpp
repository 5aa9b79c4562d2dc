#include "lobe/live/session_scene.h"

#include <algorithm>
#include <type_traits>

#include "lobe/error.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/tool_kinds.h"
#include "lobe/text.h"

namespace lobe {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw InputError("session", why); }

// The name of an edit that a scene cannot describe.
const char* edit_name(const Command& command) {
  if (std::holds_alternative<RemoveTets>(command)) return "tetrahedra were removed";
  if (std::holds_alternative<Incise>(command)) return "an incision was made";
  if (std::holds_alternative<SetRegion>(command)) return "a region was changed";
  if (std::holds_alternative<SetMassDegree>(command)) return "the degree of the masses was changed";
  if (std::holds_alternative<KeepFull>(command)) return "vertices of a reduced region were kept full";
  if (std::holds_alternative<SetForces>(command)) return "forces were set";
  if (std::holds_alternative<SetSprings>(command) || std::holds_alternative<MoveSprings>(command))
    return "springs were set";
  if (std::holds_alternative<Expand>(command) || std::holds_alternative<Condense>(command) ||
      std::holds_alternative<Relinearise>(command))
    return "a precomputed region was expanded, condensed or relinearised";
  return nullptr;
}

// The number of frames up to now, all of the same length.
template <class Real>
int frames_of(const Session<Real>& session) {
  const Recording& recording = session.recording();
  int frames = 0;
  for (std::size_t i : entries_to_the_end(recording)) {
    const Command& command = std::get<Command>(recording.commands[i].command);
    const std::string at = " at " + rounded(frames * session.frame()) + " s";
    if (const char* edit = edit_name(command))
      refuse(edit + at + ", which a scene cannot describe; a recording can");
    frames += std::holds_alternative<Advance>(command);
  }
  if (frames == 0) refuse("nothing was simulated yet");
  if (frames * session.frame() != session.world().time())
    refuse("a frame failed, after which no scene gets here; go back to before it");
  return frames;
}

// States the regions as the session has them, because another measurement might choose other ones.
void state_regions(const Setup& setup, Scene& scene) {
  const auto is_precomputed = [](const Region& region) { return region.model == RegionModel::precomputed; };
  if (!scene.auto_regions && std::none_of(scene.regions.begin(), scene.regions.end(), is_precomputed)) return;
  const double tolerance = scene.reduced_tolerance().value_or(0);
  scene.auto_regions.reset();
  scene.regions.clear();
  for (std::size_t i = 0; i < region_model_names.size(); ++i) {
    const auto model = RegionModel(i);
    if (model == Region{}.model) continue;
    SelectTetrahedra selected;
    for (Index t = 0; t < setup.mesh.tet_count(); ++t)
      if (setup.region_of[std::size_t(t)] == model) selected.tetrahedra.push_back(t);
    if (selected.tetrahedra.empty()) continue;
    Region& region = scene.regions.emplace_back();
    region.name = name(model);
    region.model = model;
    region.where = Selector{std::move(selected)};
    if (model == RegionModel::precomputed) region.frame = setup.precomputed_frame;
    if (model == RegionModel::reduced) {
      region.cell = setup.lattice_cell;
      region.tolerance = tolerance;
    }
  }
}

}  // namespace

template <class Real>
Scene session_scene(const Scene& scene, const Setup& setup, const Session<Real>& session) {
  if (session.world().journal().setup != fingerprint(setup))
    refuse("is of another scene, mesh or version of them");
  if (scene.in_double() != std::is_same_v<Real, double>)
    refuse(scene.in_double() ? "is in single precision, its scene in double"
                             : "is in double precision, its scene in single");
  const int frames = frames_of(session);
  Scene kept = scene;
  kept.mesh = std::filesystem::absolute(mesh_path(scene));
  if (!scene.condensed_cache.empty())
    kept.condensed_cache = std::filesystem::absolute(scene.file.parent_path() / scene.condensed_cache);
  if (!scene.skin.empty()) kept.skin = std::filesystem::absolute(skin_path(scene));
  kept.time.frame = session.frame();
  kept.time.duration = frames * session.frame();
  std::erase_if(kept.output.pictures, [&](double time) { return time > kept.time.duration; });
  state_regions(setup, kept);
  append_tools(session.world().tools().live_paths(), setup.mesh.vertex_count(), kept.tools);
  return kept;
}

Scene with_gestures(Scene scene, double tolerance) {
  AutoRegions regions;
  regions.tolerance = tolerance;
  for (const Tool& tool : scene.tools) {
    const auto furthest = std::max_element(
        tool.path.begin(), tool.path.end(),
        [](const PathPoint& a, const PathPoint& b) { return a.position.norm() < b.position.norm(); });
    const bool holds_copies_alone =
        !tool.copies.empty() && std::holds_alternative<SelectNot>(tool.where->value);
    if (tool.type == GraspSetup::type && !holds_copies_alone && !furthest->position.isZero(0))
      regions.gestures.push_back({tool.name, *tool.where, false, furthest->position, ""});
  }
  scene.regions.clear();
  scene.auto_regions = regions;
  return scene;
}

template Scene session_scene(const Scene&, const Setup&, const Session<float>&);
template Scene session_scene(const Scene&, const Setup&, const Session<double>&);

}  // namespace lobe
