#include "lobe/run/run.h"

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/run/frame_writer.h"
#include "lobe/run/reactions.h"
#include "lobe/run/recording.h"
#include "lobe/run/report_json.h"
#include "lobe/run/results_folder.h"
#include "lobe/run/watch_results.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/setup/exclusions.h"

namespace lobe {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

template <class Real>
bool play(World<Real>& world, const Scene& scene, const Resolved& resolved, const RunOptions& options,
          FrameWriter& frame_writer, Totals& totals, WatchResults<Real>& watches) {
  const Frames frames = frames_of(scene.time);
  const auto record = [&](bool last) {
    const Clock::time_point start = Clock::now();
    Mat3X<double> reactions;
    if (!resolved.held.empty()) reactions = reactions_of(world);
    frame_writer.record(world, reactions, last);
    Json& state = totals.series.emplace_back(state_json(world));
    if (!resolved.held.empty())
      state["reactions"] = reactions_json(resolved.held, world.elements(), reactions);
    totals.output_seconds += seconds_since(start);
  };
  record(false);
  std::optional<CommandRecorder<Real>> recorded;
  if (!options.record.empty()) recorded.emplace(world);
  bool ok = true;
  const auto look = [&] { watches.look(world, recorded ? &*recorded : nullptr); };
  look();
  for (int i = 0; i < frames.count && ok; ++i) {
    const Clock::time_point start = Clock::now();
    const double time = world.time();
    const Report report = recorded ? recorded->advance(frames.length) : world.advance(frames.length);
    look();
    totals.add(report, time, seconds_since(start));
    if (const auto& own_steps = world.body().own_steps) totals.add_levels(own_steps->shares_of_levels());
    record(!report.ok || i + 1 == frames.count);
    if (options.progress) options.progress(double(i + 1) / frames.count);
    ok = report.ok;
  }
  if (recorded) write_recording(options.record, recorded->recording());
  return ok;
}

// Parts of the report that only some scenes have.
template <class Real>
void add_parts_in_use(Json& report, const World<Real>& world, const Scene& scene, const Resolved& resolved,
                      const Totals& totals) {
  const bool is_reduced = options_of(resolved.setup).has(option_of(RegionModel::reduced));
  if (resolved.proposal && !scene.corrects_masses() && !is_reduced)
    report["auto_regions"] = proposal_json(*resolved.proposal);
  if (resolved.setup.own_steps) report["own_steps"] = own_steps_json(totals);
  if (world.grains())
    report["scalpel"] = {{"cut_area_m2", totals.cut_area},
                         {"tetrahedra_copied", totals.tets_copied},
                         {"mass_added_kg", totals.mass_added}};
}

template <class Real>
RunResult run(const Scene& scene, const Resolved& resolved, const RunOptions& options) {
  const Clock::time_point start = Clock::now();
  World<Real> world(resolved.setup, options.threads, options.condensing);
  const double setup_seconds = seconds_since(start);
  std::vector<std::filesystem::path> inputs = mesh_paths(scene);
  inputs.push_back(scene.file);
  clear_earlier_run(options.directory, inputs);
  FrameWriter frame_writer(scene.output, resolved.setup.contact.obstacles, options.directory);
  Totals totals;
  RunResult result;
  result.warnings = resolved.warnings;
  const Json regions = region_counts(world.elements());
  const double limit = world.time_step_limit();
  WatchResults<Real> watches(world, scene, resolved);
  result.ok = play(world, scene, resolved, options, frame_writer, totals, watches);
  result.picture_request = frame_writer.finish();
  for (const std::string& warning : watches.warnings()) result.warnings.push_back(warning);
  result.warnings.insert(result.warnings.end(), totals.warnings.begin(), totals.warnings.end());
  Json report{
      {"ok", result.ok},
      {"scene", scene.file.string()},
      {"mesh",
       {{"vertices", resolved.setup.mesh.vertex_count()}, {"tetrahedra", resolved.setup.mesh.tet_count()}}},
      {"precision", scene.in_double() ? "double" : "single"},
      {"integrator", name(scene.time.integrator)},
      {"threads", options.threads},
      {"regions", regions},
      {"regions_at_end", region_counts(world.elements())},
      {"simulated_s", world.time()},
      {"steps", totals.steps},
      {"time_step_s",
       {{"limit_at_rest", limit},
        {"safety", scene.time.safety},
        {"smallest", totals.smallest_step},
        {"largest", totals.largest_step}}},
      {"smallest_volume_ratio", totals.smallest_volume_ratio},
      {"tetrahedra_removed", totals.tets_removed},
      {"timing", timing_json(totals, world.time(), setup_seconds, world.body().regions.condensing())},
      {"skipped", skipped_json(totals, resolved.setup, frame_writer.frame_count())},
      {"frames", frame_writer.frame_count()},
      {"warnings", result.warnings},
      {"conditions", totals.conditions},
      {"events", totals.events},
      {"cuts", totals.cuts},
      {"series", totals.series}};
  add_parts_in_use(report, world, scene, resolved, totals);
  watches.add_to(report, totals.transitions);
  result.report = options.directory / "report.json";
  io::write_file(result.report, report.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
  result.summary = summary_of(report);
  return result;
}

}  // namespace

RunResult run_scene(const Scene& scene, const Resolved& resolved, const RunOptions& options) {
  if (scene.auto_regions && !resolved.proposal)
    throw InputError("/regions/auto",
                     "the automatic regions have not been chosen: call resolve() with choose_regions");
  if (scene.in_double()) return run<double>(scene, resolved, options);
  return run<float>(scene, resolved, options);
}

}  // namespace lobe
