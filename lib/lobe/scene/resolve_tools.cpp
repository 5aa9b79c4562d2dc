#include <cmath>
#include <utility>

#include "lobe/scene/read_shape.h"
#include "lobe/scene/tool_kinds.h"

namespace lobe {

void resolve_tools(Resolution& resolution) {
  const Scene& scene = resolution.scene;
  for (std::size_t i = 0; i < scene.tools.size(); ++i) {
    const Tool& tool = scene.tools[i];
    const std::string here = "/tools/" + std::to_string(i);
    const auto resolve = [&]<class Said>(Said said) {
      KindOf<Said>::resolve(resolution, said, here);
      list_of<typename KindOf<Said>::ToolSetup>(resolution.result.setup).push_back(std::move(said));
    };
    std::visit(resolve, tool.kind);
    const double end = tool.path().back().time;
    if (end > scene.time.duration) {
      resolution.warn(here + "/path", "ends at " + rounded(end) + " s, after the run's duration of " +
                                          rounded(scene.time.duration) + " s");
    }
  }
}

void resolve_contact(Resolution& resolution) {
  const Scene& scene = resolution.scene;
  ContactSetup& contact = resolution.result.setup.contact;
  contact = scene.contact;
  for (std::size_t i = 0; i < contact.obstacles.size(); ++i) {
    const std::string here = "/contact/obstacles/" + std::to_string(i);
    ObstacleSetup& obstacle = contact.obstacles[i];
    if (const double length = obstacle.orientation.norm(); !(std::abs(length - 1) < 1e-6))
      resolution.fail(here + "/orientation", "the quaternion has length " + rounded(length) + ", must be 1");
    if (auto shape = resolve_shape(resolution, obstacle.shape, scene.obstacle_files[i], here + "/shape"))
      obstacle.shape = *std::move(shape);
  }
  if ((contact.is_on() || !resolution.result.setup.probes.empty()) && scene.time.selective_mass > 1)
    resolution.warn("/time/selective_mass",
                    "contact is soft at first with selective masses, on a coarse mesh by more than half: "
                    "docs/contact.md");
}

}  // namespace lobe
