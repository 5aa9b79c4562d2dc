#include "lobe/run/report_json.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "lobe/diagnostics/body_figures.h"
#include "lobe/diagnostics/fields.h"
#include "lobe/text.h"

namespace lobe {

using Json = nlohmann::ordered_json;

void Totals::add(const Report& report, double time, double wall) {
  steps += report.steps;
  smallest_step = smallest_step > 0 ? std::min(smallest_step, report.time_step) : report.time_step;
  largest_step = std::max(largest_step, report.time_step);
  smallest_volume_ratio = std::min(smallest_volume_ratio, report.smallest_volume_ratio);
  simulation_seconds += wall;
  slowest_frame = std::max(slowest_frame, wall);
  for (int p = 0; p < phase_count; ++p) phases[p] += report.seconds[p];
  tets_removed += report.tets_removed;
  tets_copied += report.tets_copied;
  cut_area += report.cut_area;
  mass_added = report.mass_added;
  ++states;
  patches_evaluated += report.patches_evaluated;
  patches_skipped += report.patches_skipped;
  if (report.tets_removed > 0) cuts.push_back({{"time", time}, {"tetrahedra", report.tets_removed}});
  if (const Transitions& of = report.transitions; of.count > 0)
    transitions.push_back({{"time", time},
                           {"count", of.count},
                           {"kinetic", of.kinetic},
                           {"elastic", of.elastic},
                           {"loads", of.loads},
                           {"total", of.total()}});
  for (const Event& event : report.events) {
    Json& entry = events.emplace_back(Json{{"time", event.time}, {"event", name(event.kind)}});
    if (event.place) entry["place"] = {event.place->x(), event.place->y(), event.place->z()};
    entry["size"] = event.size;
    if (!event.text.empty()) entry["text"] = event.text;
  }
  for (const Condition& c : report.conditions) {
    conditions.push_back({{"time", c.time}, {"condition", name(c.kind)}, {"text", c.text}});
    const bool first_inversion = c.kind == Condition::Kind::near_inversion && !warned_of_inversion;
    warned_of_inversion = warned_of_inversion || first_inversion;
    if (first_inversion || c.kind == Condition::Kind::diverged || c.kind == Condition::Kind::too_stiff ||
        c.kind == Condition::Kind::unravelling)
      warnings.push_back("at " + rounded(c.time) + " s: " + c.text);
  }
}

void Totals::add_levels(const LevelRatios& shares) {
  for (std::size_t l = 0; l < shares.size(); ++l) share_of_levels[l] += shares[l];
  frames_by_levels += shares[0] < 1;
}

template <class Real>
void add_attachments(World<Real>& world, Json& state) {
  const auto gone = [](const StrandsGone& strands) {
    return Json{{"strands", strands.count}, {"area", strands.area}, {"energy", strands.energy}};
  };
  for (const AttachmentFigures& of : attachment_figures(world))
    state["attachments"].push_back({{"name", of.name},
                                    {"strands", of.strands},
                                    {"area", of.area},
                                    {"tension", of.tension},
                                    {"stored", of.stored},
                                    {"released", of.released},
                                    {"torn", gone(of.torn)},
                                    {"cut", gone(of.cut)}});
}

template <class Real>
void add_clips(World<Real>& world, Json& state) {
  for (const ClipFigures& of : clip_figures(world))
    state["clips"].push_back(
        {{"name", of.name}, {"pairs", of.pairs}, {"apart", of.apart}, {"force", of.force}});
  for (const CarrierFigures& of : carrier_figures(world))
    state["carriers"].push_back({{"body", world.elements().bodies.names[std::size_t(of.body)]},
                                 {"carries", carries_names[std::size_t(of.carries)]},
                                 {"open", of.open}});
}

template <class Real>
Json state_json(World<Real>& world) {
  const Energies e = world.energies();
  Json state{{"time", world.time()},
             {"tetrahedra", world.elements().topology.alive_count()},
             {"volume", current_volume(world.elements(), world.state().u.template cast<double>())},
             {"energy",
              {{"kinetic", e.kinetic},
               {"elastic_linear", e.elastic_linear},
               {"elastic_nonlinear", e.elastic_nonlinear},
               {"loads", e.loads},
               {"applied", e.applied},
               {"total", e.total()}}}};
  const auto array = [](const Vec3d& x) { return Json{x[0], x[1], x[2]}; };
  if (world.elements().bodies.any()) {
    const Mat3X<double> u = world.state().u.template cast<double>(),
                        v = world.state().v.template cast<double>();
    for (const BodyFigures& body : body_figures(world.elements(), u, v))
      state["bodies"].push_back({{"name", body.name},
                                 {"tetrahedra", body.tets},
                                 {"volume", body.volume},
                                 {"centre", array(body.centre)},
                                 {"momentum", array(body.momentum)},
                                 {"energy", {{"kinetic", body.kinetic}, {"elastic", body.elastic}}}});
  }
  for (const PlacedTool& tool : placed_tools(world))
    state["tools"].push_back(
        {{"name", tool.name}, {"position", array(tool.position)}, {"force", array(tool.force)}});
  add_attachments(world, state);
  add_clips(world, state);
  return state;
}

template Json state_json(World<float>&);
template Json state_json(World<double>&);

Json region_counts(const Elements& elements) {
  Json counts;
  for (const char* model : region_model_names) counts[model] = 0;
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    Json& count = counts[name(elements.region_of[std::size_t(t)])];
    count = count.get<Index>() + 1;
  }
  return counts;
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

Json own_steps_json(const Totals& totals) {
  const double frames =
      std::max(1.0, std::accumulate(totals.share_of_levels.begin(), totals.share_of_levels.end(), 0.0));
  Json levels = Json::array();
  for (std::size_t l = 0; l < totals.share_of_levels.size(); ++l)
    if (totals.share_of_levels[l] > 0)
      levels.push_back({{"times", 1 << l}, {"share", totals.share_of_levels[l] / frames}});
  const double all = double(totals.patches_evaluated + totals.patches_skipped);
  return {{"frames", totals.frames_by_levels},
          {"tetrahedra", levels},
          {"share_evaluated", all > 0 ? double(totals.patches_evaluated) / all : 1}};
}

Json skipped_json(const Totals& totals, const Setup& setup, std::size_t written) {
  const long long asleep = setup.own_steps ? 0 : totals.patches_skipped,  // which do not go together
      all = totals.patches_evaluated + asleep;
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
            {"asleep", asleep},
            {"share_asleep", all > 0 ? double(asleep) / double(all) : 0}}},
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

}  // namespace lobe
