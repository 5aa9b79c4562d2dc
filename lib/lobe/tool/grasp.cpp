#include "lobe/tool/grasp.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "lobe/error.h"

namespace lobe {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

}  // namespace

void TakeHold::check(Index vertex_count, const Options&) const {
  for (Index v : vertices)
    if (v < 0 || v >= vertex_count)
      throw InputError("vertex " + std::to_string(v),
                       "there are " + std::to_string(vertex_count) + ", numbered from 0");
  if (vertices.empty()) throw InputError("grasp", "needs at least one vertex");
}

// A row says where a tool is from `time` on only if nothing has said so before.
void Grasp::begin_frame(double time, double end) {
  if (!is_live) return;
  if (phase == Phase::released) return path.settle();
  path.forget_after(time);
  if (path.empty()) path.push_back({time, Vec3d::Zero()});
  if ((target || release) && path.back().time < time - just_before)
    path.push_back({time, path.back().position, path.back().orientation});
  if (!target || release || phase != Phase::holding) return;
  const ToolPose to = *std::exchange(target, std::nullopt);
  path.push_back({end, to.position - centre, to.orientation});
}

std::vector<GraspSetup> Grasp::paths() const {
  if (path.empty()) return {};
  return {{name, vertices, path.all(), release, shares}};
}

std::optional<PlacedTool> Grasp::placed(double time, const HeldPoints& held) const {
  PlacedTool placed{.name = name, .type = Path::type};
  for (const auto& [vertex, x] : held(id)) {
    placed.vertices.push_back(vertex);
    placed.position += x;
  }
  if (placed.vertices.empty()) return std::nullopt;
  placed.position /= double(placed.vertices.size());
  placed.orientation = orientation_at(path.recent(), time);
  placed.force = force;
  placed.torque = torque;
  return placed;
}

bool Grasp::fits(Index vertex_count) const {
  if (!shares.empty() && shares.size() != vertices.size()) return false;
  for (const double share : shares)
    if (!(share > 0 && share <= 1)) return false;
  for (Index v : vertices)
    if (v < 0 || (is_live && v >= vertex_count)) return false;
  if (path.empty() && (!is_live || phase != Phase::waiting)) return false;
  return is_path(path.all()) && centre.allFinite();
}

double Grasp::takes_hold_at() const { return path.empty() ? never : path.front().time; }

double Grasp::lets_go_at() const { return path.empty() || !release ? never : path.back().time; }

}  // namespace lobe
