// Which displacement components of a mesh are solved for, and their places in the vectors of unknowns.
#pragma once

#include <Eigen/SparseCore>

#include "lobe/fem/elements.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

struct Unknowns {
  // is_free(vertex, axis): whether that component is solved for.
  template <class IsFree>
  Unknowns(Index vertices, IsFree&& is_free) : number(3, vertices) {
    for (Index v = 0; v < vertices; ++v)
      for (int axis = 0; axis < 3; ++axis) number(axis, v) = is_free(v, axis) ? count++ : -1;
  }

  Eigen::VectorXd gather(const Mat3X<double>& full) const {
    Eigen::VectorXd x(count);
    for (Eigen::Index i = 0; i < number.size(); ++i)
      if (const Index at = number.data()[i]; at >= 0) x[at] = full.data()[i];
    return x;
  }
  Mat3X<double> scatter(const Eigen::VectorXd& x) const {  // zero where nothing is solved for
    Mat3X<double> full = Mat3X<double>::Zero(3, number.cols());
    for (Eigen::Index i = 0; i < number.size(); ++i)
      if (const Index at = number.data()[i]; at >= 0) full.data()[i] = x[at];
    return full;
  }
  void clear_prescribed(Mat3X<double>& full) const {
    for (Eigen::Index i = 0; i < number.size(); ++i)
      if (number.data()[i] < 0) full.data()[i] = 0;
  }

  Eigen::Matrix<Index, 3, Eigen::Dynamic> number;  // 3 × #vertices; −1 where the component is given
  Index count = 0;
};

// The components that nothing holds, of the vertices that have tetrahedra.
inline Unknowns free_components(const Elements& elements, const HeldVertices& held) {
  Eigen::Matrix<bool, 3, Eigen::Dynamic> prescribed =
      Eigen::Matrix<bool, 3, Eigen::Dynamic>::Zero(3, elements.topology.vertex_count());
  for (const HeldVertices::Held& item : held.all())
    for (int axis = 0; axis < 3; ++axis) prescribed(axis, item.vertex) |= item.axes[axis];
  return Unknowns(elements.topology.vertex_count(), [&](Index v, int axis) {
    return !prescribed(axis, v) && !elements.topology.around(v).empty();
  });
}

}  // namespace lobe
