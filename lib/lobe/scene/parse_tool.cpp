#include "lobe/scene/parse_tool.h"

#include "lobe/error.h"
#include "lobe/scene/json_text.h"
#include "lobe/scene/scene_document.h"
#include "lobe/scene/tool_kinds.h"

namespace lobe {
namespace {

constexpr std::string_view place_in_scene = "/tools/0", row_in_scene = "/path/0";

// The scene that has nothing but this tool, for the checks that scenes get.
nlohmann::json scene_of(nlohmann::json tool) {
  if (!tool.is_object()) throw InputError("tool", "must be a JSON object");
  if (tool.contains("path"))
    throw InputError("/path", "a hand leads this tool: say where it begins, by \"at\"");
  if (!tool.contains("at") || !tool["at"].is_array())
    throw InputError("/at", "must be a row of the tool's path, without the time");
  nlohmann::json row = {0};
  row.insert(row.end(), tool["at"].begin(), tool["at"].end());
  tool.erase("at");
  tool["path"] = nlohmann::json::array({row});
  return {{"mesh", "none"}, {"materials", {{{"lame_lambda", 1}, {"lame_mu", 1}}}}, {"tools", {tool}}};
}

// In words of the tool alone.
[[noreturn]] void fail_as_tool(std::vector<Fault> faults) {
  for (Fault& fault : faults) {
    if (fault.place.starts_with(place_in_scene)) fault.place.erase(0, place_in_scene.size());
    if (fault.place.starts_with(row_in_scene)) fault.place.replace(0, row_in_scene.size(), "/at");
    if (fault.place.empty()) fault.place = "tool";
  }
  throw InputError(std::move(faults));
}

}  // namespace

ParsedTool parse_tool(std::string_view text, const std::filesystem::path& folder) {
  const nlohmann::json document = scene_of(parse_json(text, "tool"));
  try {
    const Scene scene = read_document(document, folder / "tool.json");
    const Tool& tool = scene.tools.front();
    Resolution resolution{scene, {}, {}};
    const std::string place(place_in_scene);
    const auto bring = [&]<class Said>(const Said& said) -> BringTool {
      if constexpr (requires { KindOf<Said>::bring(resolution, said, place); })
        return KindOf<Said>::bring(resolution, said, place);
      else
        throw InputError(place + "/type",
                         "a hand takes hold of vertices, and cannot bring a " + std::string(Said::type));
    };
    const ParsedTool found{std::visit(bring, tool.kind), tool.path().front().position};
    if (!resolution.faults.empty()) throw InputError(std::move(resolution.faults));
    return found;
  } catch (const InputError& error) {
    fail_as_tool(error.faults());
  }
}

}  // namespace lobe
