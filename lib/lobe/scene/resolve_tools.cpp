#include "lobe/scene/tool_kinds.h"

namespace lobe {

void resolve_tools(Resolution& resolution) {
  const Scene& scene = resolution.scene;
  for (std::size_t i = 0; i < scene.tools.size(); ++i) {
    const Tool& tool = scene.tools[i];
    const std::string here = "/tools/" + std::to_string(i);
    kind_of(tool).resolve(resolution, tool, here);
    const double end = tool.path.back().time;
    if (end > scene.time.duration) {
      resolution.warn(here + "/path", "ends at " + rounded(end) + " s, after the run's duration of " +
                                          rounded(scene.time.duration) + " s");
    }
  }
}

}  // namespace lobe
