// The data of as many smoothing domains of a block as one register holds. Formulas of one domain start from
// these.
#pragma once

#include "lobe/numerics/simd.h"
#include "lobe/region/smoothed_kernels.h"

namespace lobe {

template <class T>  // a pack
class DomainLanes {
 public:
  using Real = typename T::value_type;
  static constexpr int count = static_cast<int>(T::size());

  DomainLanes(const SmoothedArrays<Real>& patch, Index block, int first)
      : V(&patch.blocks[block].V[first]),
        vertices(patch.blocks[block].vertices),
        rows_(patch.gradients + patch.blocks[block].first),
        first_(first) {
    if (patch.H) {
      for (int i = 0; i < 9; ++i) H(i % 3, i / 3).copy_from(&patch.H[block].entries[i][first]);
      return;
    }
    H = Mat3<T>::Constant(T(0));
    const auto* numbers = patch.numbers + patch.blocks[block].first + block;
    const Real* u = &patch.u->xyz0[0];
    const Vec3<T> origin = PaddedVectors<T>::load(u, &numbers[0][first]);
    for (Index j = 1; j < vertices; ++j) {
      const Vec3<T> d = PaddedVectors<T>::load(u, &numbers[j][first]) - origin, b = gradient(j);
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) H(r, c) += d[r] * b[c];
    }
  }

  Vec3<T> gradient(Index vertex) const {  // gradient of any vertex but the first
    Vec3<T> b;
    for (int i = 0; i < 3; ++i) b[i].copy_from(&rows_[vertex - 1].b[i][first_]);
    return b;
  }
  Vec3<T> first_gradient() const {
    Vec3<T> sum = Vec3<T>::Constant(T(0));
    for (Index j = 1; j < vertices; ++j) sum -= gradient(j);
    return sum;
  }

  T V;
  Index vertices;  // the most of a lane
  Mat3<T> H;       // ∇u

 private:
  const GradientRow<Real>* rows_;
  int first_;
};

// These terms of the law of each lane, at the pressure of its nodes, with its fibre.
template <class T, class Real = typename T::value_type>
Law<T> law_of_domains(const SmoothedArrays<Real>& patch, const Terms& terms, Index block, int first) {
  Law<T> law = patch.law.template as<T>();
  if (terms.pressure && patch.node_rows) {
    const auto& nodes = patch.node_rows[block].nodes;
    const auto at_end = [&](int end) {
      return T([&, end](auto lane) { return patch.pressure[nodes[end][first + lane]]; });
    };
    law.pressure = (at_end(0) + at_end(1)) * Real(0.5f);
  }
  if (terms.has_direction())
    for (int i = 0; i < 3; ++i) law.direction[i].copy_from(&patch.fibre_blocks[block].direction[i][first]);
  law.terms = terms;
  return law;
}

}  // namespace lobe
