// What a watch may do to a world: by the world's own functions, or those of who keeps a record of the calls.
#pragma once

#include <functional>
#include <vector>

#include "lobe/sim/world.h"

namespace lobe {

struct Steering {
  template <class Driver>
  explicit Steering(Driver& driver)
      : set_region([&](const auto& tets, RegionModel model) { return driver.set_region(tets, model); }),
        expand([&] { driver.expand(); }),
        condense([&] { driver.condense(); }),
        renew([&](double delay) { driver.renew(delay); }),
        set_mass_degree([&](int degree) { driver.set_mass_degree(degree); }) {}

  std::function<double(const std::vector<Index>& tets, RegionModel model)> set_region;
  std::function<void()> expand, condense;
  std::function<void(double delay)> renew;
  std::function<void(int degree)> set_mass_degree;
};

}  // namespace lobe
