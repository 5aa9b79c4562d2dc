#include "lobe/fit/observe.h"

#include <algorithm>
#include <numbers>

#include "lobe/diagnostics/locate.h"
#include "lobe/error.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

}  // namespace

Observations::Observations(const Resolved& resolved, std::vector<Measurement> measurements,
                           const std::string& file)
    : measurements_(std::move(measurements)), held_(resolved.held) {
  const Locator locator(resolved.setup.mesh);
  std::vector<Fault> faults;
  for (const Measurement& measurement : measurements_) {
    std::string trouble;
    places_.push_back(place_of(measurement, resolved, locator, trouble));
    if (!trouble.empty()) faults.push_back({file + ":" + std::to_string(measurement.line), trouble});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

Observations::Place Observations::place_of(const Measurement& m, const Resolved& resolved,
                                           const Locator& locator, std::string& trouble) {
  Place place;
  if (m.quantity == Quantity::displacement) {
    const TetMesh& mesh = locator.mesh();
    const Locator::Found found = locator.nearest(m.point);
    place.corners = mesh.tets.col(found.tet);
    place.weights = barycentric(mesh, found.tet, m.point);
    const Mat34<double> corners = tet_points(mesh, found.tet);
    const double size = (corners.colwise() - corners.col(0)).colwise().norm().maxCoeff();
    if (found.distance > size)
      trouble = "the point is " + rounded(1000 * found.distance) + " mm outside of the body at rest";
  } else if (m.quantity == Quantity::force && m.tool.empty()) {
    const std::string pointer = "/boundary/" + std::to_string(m.number);
    const auto entry = std::find_if(held_.begin(), held_.end(),
                                    [&](const HeldEntry& held) { return held.pointer == pointer; });
    place.force = std::size_t(entry - held_.begin());
    if (entry == held_.end()) trouble = pointer + " holds or moves nothing, so that it has no force";
  } else if (m.quantity == Quantity::force) {
    place_at_tool(m, resolved, place, trouble);
  }
  return place;
}

void Observations::place_at_tool(const Measurement& m, const Resolved& resolved, Place& place,
                                 std::string& trouble) {
  bool is_there = false;
  const ToolSetups& tools = resolved.setup;
  for_each_tool(tools, [&](const auto& tool) { is_there |= tool.name == m.tool; });
  if (!is_there)
    trouble = "\"" + m.tool + "\" is no tool of the scene, and no number of an entry of \"boundary\"";
  else if (!m.time)
    trouble = "a tool has a force in motion alone: give a time";
  auto at = std::find(tools_.begin(), tools_.end(), m.tool);
  if (at == tools_.end()) at = tools_.insert(at, m.tool);
  place.force = held_.size() + std::size_t(at - tools_.begin());
}

int Observations::frequencies() const {
  int highest = 0;
  for (const Measurement& m : measurements_)
    if (m.quantity == Quantity::frequency) highest = std::max(highest, m.number);
  return highest;
}

std::vector<double> Observations::times() const {
  std::vector<double> times;
  for (const Measurement& m : measurements_)
    if (m.time) times.push_back(*m.time);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

bool Observations::any_force() const {
  return std::any_of(measurements_.begin(), measurements_.end(),
                     [](const Measurement& m) { return m.quantity == Quantity::force; });
}

std::vector<Vec3d> Observations::forces_of(const Mat3X<double>& reactions) const {
  std::vector<Vec3d> forces;
  for (const HeldEntry& entry : held_) {
    forces.push_back(Vec3d::Zero());
    for (std::size_t k = 0; k < entry.vertices.size(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        if (entry.axes[k][std::size_t(axis)]) forces.back()[axis] += reactions(axis, entry.vertices[k]);
  }
  return forces;
}

Vec3d Observations::vector_at(std::size_t i, const Mat3X<double>& u, const std::vector<Vec3d>& forces) const {
  const Place& place = places_[i];
  if (measurements_[i].quantity == Quantity::force) return forces[place.force];
  Vec3d sum = Vec3d::Zero();
  for (int c = 0; c < 4; ++c) sum += place.weights[c] * u.col(place.corners[c]);
  return sum;
}

double Observations::value_at(std::size_t i, const Mat3X<double>& u, const std::vector<Vec3d>& forces) const {
  const Vec3d vector = vector_at(i, u, forces);
  const int component = measurements_[i].component;
  return component == length_of_vector ? vector.norm() : vector[component];
}

void Observations::read(double time, const Mat3X<double>& u, const std::vector<Vec3d>& forces,
                        Eigen::VectorXd& values) const {
  for (std::size_t i = 0; i < measurements_.size(); ++i)
    if (measurements_[i].time == time) values[Eigen::Index(i)] = value_at(i, u, forces);
}

Eigen::VectorXd Observations::values(const Mat3X<double>& u, const Mat3X<double>& reactions,
                                     const Eigen::VectorXd& omega) const {
  const std::vector<Vec3d> forces = forces_of(reactions);
  Eigen::VectorXd values(Eigen::Index(measurements_.size()));
  for (std::size_t i = 0; i < measurements_.size(); ++i) {
    const Measurement& m = measurements_[i];
    values[Eigen::Index(i)] =
        m.quantity == Quantity::frequency ? omega[m.number - 1] / two_pi : value_at(i, u, forces);
  }
  return values;
}

Eigen::VectorXd Observations::derivatives(const Mat3X<double>& u, const Mat3X<double>& reactions,
                                          const StaticDerivative& by, const Eigen::VectorXd& omega_by) const {
  const std::vector<Vec3d> forces = forces_of(reactions), forces_by = forces_of(by.reactions);
  Eigen::VectorXd slopes(Eigen::Index(measurements_.size()));
  for (std::size_t i = 0; i < measurements_.size(); ++i) {
    const Measurement& m = measurements_[i];
    double& slope = slopes[Eigen::Index(i)];
    if (m.quantity == Quantity::frequency) {
      slope = omega_by[m.number - 1] / two_pi;
      continue;
    }
    const Vec3d vector = vector_at(i, u, forces), change = vector_at(i, by.u, forces_by);
    const double length = vector.norm();
    if (m.component == length_of_vector)
      slope = length > 0 ? vector.dot(change) / length : 0;
    else
      slope = change[m.component];
  }
  return slopes;
}

}  // namespace lobe
