// What a solution says at the places of measurements, and how it changes with that solution.
#pragma once

#include <span>

#include "lobe/fit/measurements.h"
#include "lobe/scene/resolve.h"
#include "lobe/solve/static_sensitivity.h"

namespace lobe {

class Locator;

class Observations {
 public:
  // Throws one InputError for all points that are outside of the body by more than an edge of the nearest
  // tetrahedron, and for entries of "boundary" that there are not.
  Observations(const Resolved& resolved, std::vector<Measurement> measurements, const std::string& file);

  const std::vector<Measurement>& measurements() const { return measurements_; }
  bool any_frequency() const { return frequencies() > 0; }
  int frequencies() const;  // number of the highest one that was measured

  // Computed values at an equilibrium with frequencies omega [rad/s], in the measurements' order and units.
  Eigen::VectorXd values(const Mat3X<double>& u, const Mat3X<double>& reactions,
                         const Eigen::VectorXd& omega) const;
  // Their derivatives, from those of the equilibrium `at` and of its frequencies.
  Eigen::VectorXd derivatives(const Mat3X<double>& u, const Mat3X<double>& reactions,
                              const StaticDerivative& by, const Eigen::VectorXd& omega_by) const;

 private:
  struct Place {
    Eigen::Vector4i corners = Eigen::Vector4i::Zero();
    Eigen::Vector4d weights = Eigen::Vector4d::Zero();
    std::vector<Index> vertices;  // vertices of an entry of "boundary"
    std::vector<Axes> axes;
  };
  Place place_of(const Measurement& measurement, const Resolved& resolved, const Locator& locator,
                 std::string& trouble) const;
  Vec3d vector_at(std::size_t i, const Mat3X<double>& u, const Mat3X<double>& reactions) const;

  std::vector<Measurement> measurements_;
  std::vector<Place> places_;
};

}  // namespace lobe
