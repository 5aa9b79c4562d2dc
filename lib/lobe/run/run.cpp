#include "lobe/run/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "lobe/diagnostics/fields.h"
#include "lobe/error.h"
#include "lobe/io/atomic_file.h"
#include "lobe/run/recorder.h"
#include "lobe/run/recording.h"
#include "lobe/run/watched.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/read_scene.h"
#include "lobe/text.h"

namespace lobe {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Sums of the reports of all frames.
struct Totals {
  long long steps = 0;
  double smallest_step = 0, largest_step = 0;  // [s]
  double smallest_volume_ratio = 1;
  double simulation_seconds = 0, slowest_frame = 0, output_seconds = 0;  // wall
  std::array<double, phase_count> phases{};
  Json cuts = Json::array(), conditions = Json::array(), series = Json::array();
  Index tets_removed = 0;
  long long states = 1, patches_evaluated = 0, patches_skipped = 0;
  std::vector<std::string> warnings;
  bool warned_of_inversion = false;

  void add(const Report& report, double time, double wall);
};

void Totals::add(const Report& report, double time, double wall) {
  steps += report.steps;
  smallest_step = smallest_step > 0 ? std::min(smallest_step, report.time_step) : report.time_step;
  largest_step = std::max(largest_step, report.time_step);
  smallest_volume_ratio = std::min(smallest_volume_ratio, report.smallest_volume_ratio);
  simulation_seconds += wall;
  slowest_frame = std::max(slowest_frame, wall);
  for (int p = 0; p < phase_count; ++p) phases[p] += report.seconds[p];
  tets_removed += report.tets_removed;
  ++states;
  patches_evaluated += report.patches_evaluated;
  patches_skipped += report.patches_skipped;
  if (report.tets_removed > 0) cuts.push_back({{"time", time}, {"tetrahedra", report.tets_removed}});
  for (const Condition& c : report.conditions) {
    conditions.push_back({{"time", c.time}, {"condition", name(c.kind)}, {"text", c.text}});
    const bool first_inversion = c.kind == Condition::Kind::near_inversion && !warned_of_inversion;
    warned_of_inversion = warned_of_inversion || first_inversion;
    if (first_inversion || c.kind == Condition::Kind::diverged || c.kind == Condition::Kind::too_stiff ||
        c.kind == Condition::Kind::unravelling)
      warnings.push_back("at " + rounded(c.time) + " s: " + c.text);
  }
}

template <class Real>
Json state_json(World<Real>& world) {
  const Energies e = world.energies();
  return {{"time", world.time()},
          {"tetrahedra", world.elements().topology.alive_count()},
          {"volume", current_volume(world.elements(), world.state().u.template cast<double>())},
          {"energy",
           {{"kinetic", e.kinetic},
            {"elastic_linear", e.elastic_linear},
            {"elastic_nonlinear", e.elastic_nonlinear},
            {"loads", e.loads},
            {"total", e.total()}}}};
}

Json region_counts(const Elements& elements) {
  std::array<Index, 3> count{};
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) ++count[std::size_t(elements.region_of[t])];
  return {{"tensor-mass", count[0]}, {"precomputed", count[1]}, {"nonlinear", count[2]}};
}

Json timing_json(const Totals& totals, double simulated, double setup_seconds,
                 const CondensingLog& condensing) {
  Json phases;
  double known = 0;
  for (int p = 0; p < phase_count; ++p) {
    phases[phase_names[p]] = totals.phases[p];
    known += totals.phases[p];
  }
  phases["other"] = std::max(0.0, totals.simulation_seconds - known);
  Json condensing_s;
  for (std::size_t p = 0; p < condensing_phases.size(); ++p)
    condensing_s[condensing_phases[p]] = condensing.seconds()[p];
  return {{"setup_s", setup_seconds},
          {"condensing_s", condensing_s},
          {"simulation_s", totals.simulation_seconds},
          {"output_s", totals.output_seconds},
          {"slowest_frame_s", totals.slowest_frame},
          {"real_time_factor", totals.simulation_seconds > 0 ? simulated / totals.simulation_seconds : 0},
          {"phases_s", phases}};
}

// What the run did not compute: patches that slept, states that nobody asked to see, terms that the scene
// leaves out.
Json skipped_json(const Totals& totals, const Setup& setup, std::size_t written) {
  const long long all = totals.patches_evaluated + totals.patches_skipped;
  Json terms = Json::array();
  const auto unless = [&](bool asked, const char* term) {
    if (!asked) terms.push_back(term);
  };
  unless(setup.volume_penalty > 0, "volume_penalty");
  unless(setup.guard_below > 0, "guard_below");
  unless(any_nodal_pressure(setup.materials), "nodal_pressure");
  unless(setup.damping > 0, "damping");
  unless(!setup.gravity.isZero(0), "gravity");
  unless(setup.load_ramp > 0, "load_ramp");
  unless(setup.sleep > 0, "sleep");
  return {{"patches",
           {{"evaluated", totals.patches_evaluated},
            {"asleep", totals.patches_skipped},
            {"share_asleep", all > 0 ? double(totals.patches_skipped) / double(all) : 0}}},
          {"states_not_written", totals.states - static_cast<long long>(written)},
          {"terms", terms}};
}

Json proposal_json(const Proposal& proposal) {
  Json gestures = Json::array();
  for (const GestureOutcome& gesture : proposal.gestures)
    gestures.push_back({{"name", gesture.name},
                        {"reached", gesture.reached},
                        {"predicted_error", gesture.predicted},
                        {"measured_error", gesture.measured}});
  return {{"linear_share", proposal.linear_share},
          {"predicted_speedup", proposal.predicted_speedup},
          {"measured_speedup", proposal.measured_speedup},
          {"gestures", gestures}};
}

std::string summary_of(const Json& report) {
  const Json& timing = report["timing"];
  char line[512];
  std::snprintf(
      line, sizeof line,
      "simulated %.3f s in %lld steps of %.4g … %.4g s\n"
      "wall time %.3f s on %d thread(s): %.2f times real time; slowest frame %.1f ms\n"
      "tetrahedra removed %d, left %d; volume %.6g → %.6g m³\n",
      report["simulated_s"].get<double>(), report["steps"].get<long long>(),
      report["time_step_s"]["smallest"].get<double>(), report["time_step_s"]["largest"].get<double>(),
      timing["simulation_s"].get<double>(), report["threads"].get<int>(),
      timing["real_time_factor"].get<double>(), 1e3 * timing["slowest_frame_s"].get<double>(),
      report["tetrahedra_removed"].get<int>(), report["series"].back()["tetrahedra"].get<int>(),
      report["series"].front()["volume"].get<double>(), report["series"].back()["volume"].get<double>());
  return line;
}

// prefix, a number, suffix.
bool is_numbered(const std::string& file, const std::string& prefix, const std::string& suffix) {
  if (!file.starts_with(prefix) || !file.ends_with(suffix) || file.size() <= prefix.size() + suffix.size())
    return false;
  const std::string number = file.substr(prefix.size(), file.size() - prefix.size() - suffix.size());
  return number.find_first_not_of("0123456789.e-+") == std::string::npos;
}

bool is_result(const std::string& file) {
  return is_numbered(file, "frame_", ".vtu") || is_numbered(file, "picture_", ".png") ||
         file == "report.json" || file == "series.pvd" || file == "pictures.json";
}

// Makes the directory and removes what an earlier run left in it; before it removes anything, it refuses to
// remove what this run is made from.
void clear_earlier_run(const std::filesystem::path& directory,
                       const std::vector<std::filesystem::path>& inputs) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory, error))
    throw InputError(directory.string(), "cannot be made a directory for the results");
  std::vector<std::filesystem::path> earlier;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error))
    if (is_result(entry.path().filename().string())) earlier.push_back(entry.path());
  for (const std::filesystem::path& file : earlier)
    for (const std::filesystem::path& input : inputs)
      if (std::filesystem::equivalent(file, input, error))
        throw InputError(input.string(), "would be overwritten by the results; choose another directory");
  for (const std::filesystem::path& file : earlier) std::filesystem::remove(file, error);
}

template <class Real>
bool play(World<Real>& world, const Scene& scene, const RunOptions& options, Recorder& recorder,
          Totals& totals, Watched<Real>& watched, WatchedMasses<Real>& masses) {
  const Frames frames = frames_of(scene.time);
  const auto record = [&](bool last) {
    const Clock::time_point start = Clock::now();
    recorder.record(world, last);
    totals.series.push_back(state_json(world));
    totals.output_seconds += seconds_since(start);
  };
  record(false);
  std::optional<Recorded<Real>> recorded;
  if (!options.record.empty()) recorded.emplace(world);
  bool ok = true;
  const auto look = [&] {
    watched.look(world, recorded ? &*recorded : nullptr);
    masses.look(world, recorded ? &*recorded : nullptr);
  };
  look();
  for (int i = 0; i < frames.count && ok; ++i) {
    const Clock::time_point start = Clock::now();
    const double time = world.time();
    const Report report = recorded ? recorded->advance(frames.length) : world.advance(frames.length);
    look();
    totals.add(report, time, seconds_since(start));
    record(!report.ok || i + 1 == frames.count);
    if (options.progress) options.progress(double(i + 1) / frames.count);
    ok = report.ok;
  }
  if (recorded) write_recording(options.record, recorded->recording());
  return ok;
}

template <class Real>
RunResult run(const Scene& scene, const Resolved& resolved, const RunOptions& options) {
  const Clock::time_point start = Clock::now();
  World<Real> world(resolved.setup, options.threads, options.condensing);
  const double setup_seconds = seconds_since(start);
  clear_earlier_run(options.directory, {mesh_path(scene), scene.file});
  Recorder recorder(scene.output, options.directory);
  Totals totals;
  RunResult result;
  result.warnings = resolved.warnings;
  const Json regions = region_counts(world.elements());
  const double limit = world.time_step_limit();
  Watched<Real> watched(world, scene, resolved);
  WatchedMasses<Real> masses(world, scene);
  result.ok = play(world, scene, options, recorder, totals, watched, masses);
  result.picture_request = recorder.finish();
  for (const std::string& warning : {watched.warning(), masses.warning()})
    if (!warning.empty()) result.warnings.push_back(warning);
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
      {"skipped", skipped_json(totals, resolved.setup, recorder.frame_count())},
      {"frames", recorder.frame_count()},
      {"warnings", result.warnings},
      {"conditions", totals.conditions},
      {"cuts", totals.cuts},
      {"series", totals.series}};
  if (resolved.proposal && !scene.corrects_masses())
    report["auto_regions"] = proposal_json(*resolved.proposal);
  if (watched.any()) report["linearity"] = watched.json();
  if (const std::optional<Json> seen = masses.json()) report["selective_mass"] = *seen;
  if (const MassScaling& scaling = world.body().inertia.scaling(); scaling.added > 0)
    report["mass_scaling"] = {{"added_kg", scaling.added},
                              {"share", scaling.share},
                              {"limit_before_s", scaling.limit_before},
                              {"limit_after_s", scaling.limit_after}};
  result.report = options.directory / "report.json";
  io::write_file(result.report, report.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
  result.summary = summary_of(report);
  return result;
}

}  // namespace

RunResult run_scene(const Scene& scene, const Resolved& resolved, const RunOptions& options) {
  if (scene.auto_regions && !resolved.proposal)
    throw InputError("/regions/auto", "the regions have not been chosen: call propose()");
  if (scene.in_double()) return run<double>(scene, resolved, options);
  return run<float>(scene, resolved, options);
}

}  // namespace lobe
