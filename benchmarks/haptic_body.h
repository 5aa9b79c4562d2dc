// The liver of `lobe bench haptic`, and where a hand holds or touches it.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/benchmarks.h"
#include "benchmarks/held_liver.h"

namespace lobe::bench {

inline const Vec3d inwards = Vec3d(-1, 0.5, -0.6).normalized();  // at the tip of the left lobe
inline const Vec3d along = inwards.cross(Vec3d::UnitZ()).normalized();

struct HapticBody {
  std::string mesh;
  Setup setup;
  std::vector<Index> contact;  // what a hand holds
};

// Writes haptic.csv: forces between frames against the same body in frames of 1 ms.
void compare_predictions(const Options& options, const std::vector<HapticBody>& bodies);

}  // namespace lobe::bench
