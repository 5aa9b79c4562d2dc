// Measures a running simulation some times a second, between two frames: its energies, and a field on its
// surface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lobe/linearity/watch.h"
#include "lobe/region/nodal_pressure.h"
#include "lobe/sim/world.h"

namespace lobe::view {

struct Measured {
  std::uint64_t number = 0;         // counted from 1
  double time = 0;                  // [s]
  double elastic = 0, kinetic = 0;  // [J]
  double linear_error = -1;         // of the displacement, estimated, of its largest norm since it was first
                                    // asked for; below 0: not found, or nothing has moved since
  std::string scalar = "none";
  std::uint64_t revision = 0;  // of the surface
  std::vector<float> values;   // per vertex of it, of `scalar`
};

template <class Real>
class Gauge {
 public:
  // `scalar`: "none"; "von_mises" [Pa]; "volume_ratio"; "linear_error", by which linear regions displace each
  // part wrongly [m]. O(#tetrahedra). The first "linear_error" takes as long as setting up its watch
  // (linearity/watch.h).
  void measure(World<Real>& world, const std::string& scalar, Measured& measured);

 private:
  std::vector<double> pressures(const World<Real>& world, const Mat3X<double>& u);
  void find_stress(World<Real>& world, bool is_stress, std::vector<float>& values);
  void find_error(World<Real>& world, Measured& measured);

  std::unique_ptr<LinearityWatch<Real>> watch_;
  double most_moved_ = 0;  // since there is a watch: the largest displacement [m]
  PressureNodes nodes_;
  std::size_t nodes_edits_ = SIZE_MAX;  // of the world's history that they know
  std::uint64_t nodes_restored_ = 0;
};

}  // namespace lobe::view
