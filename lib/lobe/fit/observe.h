// What a body shows at the places of measurements, in equilibrium or in motion, and how it changes.
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
  // tetrahedron, for entries of "boundary" and tools that there are not, and for tools in equilibrium.
  Observations(const Resolved& resolved, std::vector<Measurement> measurements, const std::string& file);

  const std::vector<Measurement>& measurements() const { return measurements_; }
  bool any_frequency() const { return frequencies() > 0; }
  int frequencies() const;  // number of the highest one that was measured

  // ---- In equilibrium
  // Computed values at an equilibrium with frequencies omega [rad/s], in the measurements' order and units.
  Eigen::VectorXd values(const Mat3X<double>& u, const Mat3X<double>& reactions,
                         const Eigen::VectorXd& omega) const;
  // Their derivatives, from those of the equilibrium `at` and of its frequencies.
  Eigen::VectorXd derivatives(const Mat3X<double>& u, const Mat3X<double>& reactions,
                              const StaticDerivative& by, const Eigen::VectorXd& omega_by) const;

  // ---- In motion
  // Times of the measurements, ascending, each once [s]; none: they are of the equilibrium.
  std::vector<double> times() const;
  bool any_force() const;
  const std::vector<HeldEntry>& held() const { return held_; }      // entries of "boundary"
  const std::vector<std::string>& tools() const { return tools_; }  // tools with a measured force
  // Puts the values of one time into their places. `forces` on the body: of all entries, then of all tools.
  void read(double time, const Mat3X<double>& u, const std::vector<Vec3d>& forces,
            Eigen::VectorXd& values) const;

 private:
  struct Place {
    Eigen::Vector4i corners = Eigen::Vector4i::Zero();
    Eigen::Vector4d weights = Eigen::Vector4d::Zero();
    std::size_t force = 0;  // number among the forces of entries and tools
  };
  Place place_of(const Measurement& measurement, const Resolved& resolved, const Locator& locator,
                 std::string& trouble);
  void place_at_tool(const Measurement& measurement, const Resolved& resolved, Place& place,
                     std::string& trouble);
  std::vector<Vec3d> forces_of(const Mat3X<double>& reactions) const;
  Vec3d vector_at(std::size_t i, const Mat3X<double>& u, const std::vector<Vec3d>& forces) const;
  double value_at(std::size_t i, const Mat3X<double>& u, const std::vector<Vec3d>& forces) const;

  std::vector<Measurement> measurements_;
  std::vector<Place> places_;
  std::vector<HeldEntry> held_;
  std::vector<std::string> tools_;
};

}  // namespace lobe
