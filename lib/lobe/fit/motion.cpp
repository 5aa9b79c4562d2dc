#include "lobe/fit/motion.h"

#include <algorithm>

#include "lobe/scene/held_forces.h"

namespace lobe {
namespace {

constexpr double same_time = 1e-9;  // of a frame

// Of all entries of "boundary", then of all tools with a measured force [N].
std::vector<Vec3d> forces_shown(World<double>& world, const Observations& observed) {
  if (!observed.any_force()) return {};
  std::vector<Vec3d> forces = held_forces(observed.held(), world.elements(), reactions_of(world));
  const std::vector<PlacedTool> placed = placed_tools(world);
  for (const std::string& name : observed.tools()) {
    const auto tool =
        std::find_if(placed.begin(), placed.end(), [&](const PlacedTool& t) { return t.name == name; });
    forces.push_back(tool == placed.end() ? Vec3d::Zero().eval() : tool->force);
  }
  return forces;
}

// Advances to a time by frames that end every `frame` seconds after the start.
bool advance_to(World<double>& world, double time, double frame, std::string& trouble) {
  while (world.time() < time - same_time * frame) {
    const double next = frame * (1 + std::floor(world.time() / frame + same_time));
    const double end = next < time - same_time * frame ? next : time;
    const Report report = world.advance(end - world.time());
    if (report.ok) continue;
    trouble = report.conditions.empty() ? "the motion could not be computed" : report.conditions.back().text;
    return false;
  }
  return true;
}

}  // namespace

std::optional<Eigen::VectorXd> values_in_motion(const Setup& setup, const Observations& observed,
                                                double frame, std::string& trouble) {
  World<double> world(setup);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(Eigen::Index(observed.measurements().size()));
  for (const double time : observed.times()) {
    if (!advance_to(world, time, frame, trouble)) return {};
    observed.read(time, world.displacements(), forces_shown(world, observed), values);
  }
  return values;
}

}  // namespace lobe
