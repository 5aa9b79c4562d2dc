#include "pace.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/sim/world.h"

namespace lobe::view {
namespace {

constexpr int cells = 12;      // along each side of the block
constexpr int frames = 6;      // after the first
constexpr double side = 0.08;  // [m]

constexpr const char* falling_block = R"({
  "name": "block", "mesh": "block.vtu", "materials": [{"tissue": "liver"}],
  "volume_penalty": 34800, "guard_below": 0.2, "gravity": [0, 0, -9.81],
  "boundary": [{"fix": true,
                "where": {"plane": {"point": [0, 0, 0.001], "normal": [0, 0, 1], "side": "below"}}}],
  "time": {"duration": 1, "damping": 15}})";

}  // namespace

double measured_pace(int threads) {
  using Clock = std::chrono::steady_clock;
  const Scene scene = parse_scene(falling_block, "block.json");
  World<float> world(resolve(scene, box_mesh({side, side, side}, cells, cells, cells)).setup, threads);
  const double tets = world.elements().topology.alive_count();
  double least = std::numeric_limits<double>::infinity();
  for (int frame = 0; frame <= frames; ++frame) {
    const auto begin = Clock::now();
    const Report report = world.advance(1.0 / 120);
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    if (frame > 0 && report.ok && report.steps > 0) least = std::min(least, seconds / (report.steps * tets));
  }
  return std::isfinite(least) ? least : 0;
}

}  // namespace lobe::view
