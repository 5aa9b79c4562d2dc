// The data of as many tetrahedra of a block as one register holds. Formulas of one element start from these.
#pragma once

#include "lobe/fem/shape.h"
#include "lobe/numerics/simd.h"
#include "lobe/region/element_block.h"

namespace lobe {

template <class T>  // a pack
struct ElementLanes {
  using Real = typename T::value_type;
  static constexpr int count = static_cast<int>(T::size());

  ElementLanes(const ElementBlock<Real>& block, int first,
               const PaddedVector<Real>* u)  // per vertex of the patch [m]
      : V(&block.V[first]) {
    Mat34<T> at_corners;
    unrolled<4>(
        [&](int c) { at_corners.col(c) = PaddedVectors<T>::load(&u->xyz0[0], &block.corners[c][first]); });
    for (int i = 0; i < 9; ++i) alpha(i % 3, i / 3).copy_from(&block.alpha[i][first]);
    H = displacement_gradient(at_corners, alpha);
  }

  Vec3<T> gradient(int corner) const {  // α of any of the four corners
    if (corner > 0) return alpha.col(corner - 1);
    return -(alpha.col(0) + alpha.col(1) + alpha.col(2));
  }

  static T pressure(const PressureBlock<Real>& block, int first, const Real* at_nodes) {  // p_T [Pa]
    T sum = 0;
    for (int c = 0; c < 4; ++c) sum += T([&](auto lane) { return at_nodes[block.nodes[c][first + lane]]; });
    return sum * Real(0.25f);
  }

  static Vec3<T> direction(const FibreBlock<Real>& block, int first) {
    Vec3<T> a;
    for (int i = 0; i < 3; ++i) a[i].copy_from(&block.direction[i][first]);
    return a;
  }

  T V;
  Mat3<T> alpha, H;  // α_1, α_2, α_3; ∇u
};

}  // namespace lobe
