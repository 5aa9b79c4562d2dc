// Measures a running simulation some times a second, between two frames: its energies, and a field on its
// surface.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lobe/linearity/reduced_watch.h"
#include "lobe/linearity/watch.h"
#include "lobe/region/averages.h"
#include "lobe/sim/world.h"

namespace lobe::view {

struct Measured {
  std::uint64_t number = 0;         // counted from 1
  double time = 0;                  // [s]
  double elastic = 0, kinetic = 0;  // [J]
  double linear_error = -1;         // estimated error of the displacement, over its largest norm since it was
                                    // first asked for; below 0: not found, or nothing has moved since
  std::string scalar = "none";
  std::uint64_t revision = 0;  // revision of the surface
  std::vector<float> values;   // `scalar` at each of its vertices
};

template <class Real>
class Gauge {
 public:
  // `scalar`: "none"; "von_mises" [Pa]; "volume_ratio"; "linear_error", by which linear and reduced regions
  // displace each part wrongly [m]. O(#tetrahedra). The first "linear_error" takes as long as setting up its
  // watches (linearity/watch.h, linearity/reduced_watch.h).
  void measure(World<Real>& world, const std::string& scalar, Measured& measured);

  // While "linear_error" is measured of a world with reduced regions, they are watched after each frame.
  bool follows() const { return reduced_ != nullptr; }
  void follow(World<Real>& world);

 private:
  std::vector<double> pressures(const World<Real>& world, const Mat3X<double>& u);
  void find_stress(World<Real>& world, bool is_stress, std::vector<float>& values);
  void find_error(World<Real>& world, Measured& measured);

  std::unique_ptr<LinearityWatch<Real>> watch_;
  std::unique_ptr<ReducedWatch<Real>> reduced_;  // watch, from when it is asked for, while it is measured
  double reduced_error_ = 0, followed_ = -1;     // `followed_`: time of the last frame [s]
  double most_moved_ = 0;                        // largest displacement since there is a watch [m]
  std::optional<Averages> averages_;
  EditReader averages_edits_;
};

}  // namespace lobe::view
