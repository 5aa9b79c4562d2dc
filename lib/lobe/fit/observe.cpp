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
    : measurements_(std::move(measurements)) {
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
                                           const Locator& locator, std::string& trouble) const {
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
  } else if (m.quantity == Quantity::force) {
    const std::string pointer = "/boundary/" + std::to_string(m.number);
    const auto entry = std::find_if(resolved.held.begin(), resolved.held.end(),
                                    [&](const HeldEntry& held) { return held.pointer == pointer; });
    if (entry == resolved.held.end()) {
      trouble = pointer + " holds or moves nothing, so that it has no force";
      return place;
    }
    place.vertices = entry->vertices;
    place.axes = entry->axes;
  }
  return place;
}

int Observations::frequencies() const {
  int highest = 0;
  for (const Measurement& m : measurements_)
    if (m.quantity == Quantity::frequency) highest = std::max(highest, m.number);
  return highest;
}

Vec3d Observations::vector_at(std::size_t i, const Mat3X<double>& u, const Mat3X<double>& reactions) const {
  const Place& place = places_[i];
  Vec3d sum = Vec3d::Zero();
  if (measurements_[i].quantity == Quantity::displacement)
    for (int c = 0; c < 4; ++c) sum += place.weights[c] * u.col(place.corners[c]);
  for (std::size_t k = 0; k < place.vertices.size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      if (place.axes[k][std::size_t(axis)]) sum[axis] += reactions(axis, place.vertices[k]);
  return sum;
}

Eigen::VectorXd Observations::values(const Mat3X<double>& u, const Mat3X<double>& reactions,
                                     const Eigen::VectorXd& omega) const {
  Eigen::VectorXd values(Eigen::Index(measurements_.size()));
  for (std::size_t i = 0; i < measurements_.size(); ++i) {
    const Measurement& m = measurements_[i];
    double& value = values[Eigen::Index(i)];
    if (m.quantity == Quantity::frequency) {
      value = omega[m.number - 1] / two_pi;
      continue;
    }
    const Vec3d vector = vector_at(i, u, reactions);
    value = m.component == length_of_vector ? vector.norm() : vector[m.component];
  }
  return values;
}

Eigen::VectorXd Observations::derivatives(const Mat3X<double>& u, const Mat3X<double>& reactions,
                                          const StaticDerivative& by, const Eigen::VectorXd& omega_by) const {
  Eigen::VectorXd slopes(Eigen::Index(measurements_.size()));
  for (std::size_t i = 0; i < measurements_.size(); ++i) {
    const Measurement& m = measurements_[i];
    double& slope = slopes[Eigen::Index(i)];
    if (m.quantity == Quantity::frequency) {
      slope = omega_by[m.number - 1] / two_pi;
      continue;
    }
    const Vec3d vector = vector_at(i, u, reactions), change = vector_at(i, by.u, by.reactions);
    const double length = vector.norm();
    if (m.component == length_of_vector)
      slope = length > 0 ? vector.dot(change) / length : 0;
    else
      slope = change[m.component];
  }
  return slopes;
}

}  // namespace lobe
