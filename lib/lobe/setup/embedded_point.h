// A point of the tissue: where it lies in a tetrahedron. forces/embedded.h has what it does.
#pragma once

#include <tuple>

#include "lobe/types.h"

namespace lobe {

struct EmbeddedPoint {
  Index tet = -1;
  Eigen::Vector4d weights = Eigen::Vector4d::Zero();  // barycentric coordinates; their sum is 1

  bool operator==(const EmbeddedPoint&) const = default;
  bool is_valid() const {
    return tet >= 0 && weights.allFinite() && weights.cwiseAbs().maxCoeff() < 1e3 &&
           weights.sum() > 1 - 1e-6 && weights.sum() < 1 + 1e-6;
  }
  static constexpr auto fields = std::tuple(&EmbeddedPoint::tet, &EmbeddedPoint::weights);
};

}  // namespace lobe
