// Whether it pays to condense a region: the interface costs a dense product, its tetrahedra a sparse one.
#pragma once

#include "lobe/region/elements.h"

namespace lobe {

struct InterfaceSize {
  Index vertices = 0;  // shared by tetrahedra of this model and of others
  Index tets = 0;      // of this model

  // 9 n_b² multiplications against those of tensor-mass, as measured on one thread in single precision (benchmarks.md).
  Index most_that_pay() const;
  bool pays() const { return vertices <= most_that_pay(); }
};
InterfaceSize interface_size(const Elements& elements, RegionModel model = RegionModel::precomputed);

}  // namespace lobe
