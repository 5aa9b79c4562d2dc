#include "lobe/scene/pace_text.h"

#include <sstream>

#include "lobe/scene/pace.h"
#include "lobe/text.h"

namespace lobe {

nlohmann::ordered_json summarise_pace(const Scene& scene, const Resolved& resolved) {
  if (scene.auto_regions && !resolved.proposal) return nullptr;
  const std::optional<Pace> pace = pace_at_rest(resolved.setup);
  const bool is_on = scene.time.own_steps;
  if (!pace && !is_on) return nullptr;
  if (!pace) return {{"own_steps", true}, {"evaluations", 1}};
  nlohmann::ordered_json materials = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < pace->materials.size(); ++i)
    materials.push_back({{"name", scene.materials[i].name}, {"up_to_times", 1 << pace->materials[i]}});
  return {{"own_steps", is_on},
          {"stable_time_step_s", pace->time_step},
          {"materials", materials},
          {"evaluations", pace->evaluations}};
}

std::string pace_lines(const nlohmann::ordered_json& pace) {
  const bool is_on = pace["own_steps"];
  if (!pace.contains("materials"))
    return "pace       own steps would spare less than a fifth of the work: all parts step together\n";
  std::ostringstream out;
  out << "pace       steps of at most " << rounded(pace["stable_time_step_s"]) << " s for all; ";
  const char* separator = "";
  for (const auto& material : pace["materials"]) {
    out << separator << material["name"].get<std::string>() << (is_on ? " takes" : " could take") << " up to "
        << material["up_to_times"] << " times as long ones";
    separator = ", ";
  }
  out << "\n           (estimate at rest: " << (is_on ? "own steps take " : "\"own_steps\" would take ")
      << rounded(pace["evaluations"]) << " of the evaluations of forces)\n";
  return out.str();
}

}  // namespace lobe
