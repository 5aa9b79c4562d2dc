#include "lobe/scene/pace_text.h"

#include <sstream>

#include "lobe/scene/pace.h"
#include "lobe/text.h"

namespace lobe {

nlohmann::ordered_json summarise_pace(const Scene& scene, const Resolved& resolved) {
  if (scene.auto_regions && !resolved.proposal) return nullptr;
  const std::optional<Pace> pace = pace_at_rest(resolved.setup);
  if (!pace || pace->by_tets > Pace::worth_telling) return nullptr;
  nlohmann::ordered_json materials = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < pace->materials.size(); ++i)
    if (const Pace::Part& part = pace->materials[i]; part.lowest <= part.highest)
      materials.push_back({{"name", scene.materials[i].name}, {"up_to_times", 1 << part.highest}});
  return {{"stable_time_step_s", pace->time_step},
          {"materials", materials},
          {"evaluations_by_tetrahedra", pace->by_tets},
          {"evaluations_by_patches", pace->by_patches}};
}

std::string pace_lines(const nlohmann::ordered_json& pace) {
  std::ostringstream out;
  out << "pace       steps of at most " << rounded(pace["stable_time_step_s"]) << " s for all; alone, ";
  const char* separator = "";
  for (const auto& material : pace["materials"]) {
    out << separator << material["name"].get<std::string>() << " could take up to " << material["up_to_times"]
        << " times as long ones";
    separator = ", ";
  }
  out << "\n           (estimate: steps of their own would take "
      << rounded(pace["evaluations_by_tetrahedra"]) << " of the evaluations, "
      << rounded(pace["evaluations_by_patches"]) << " by patches; \"own_steps\" takes them)\n";
  return out.str();
}

}  // namespace lobe
