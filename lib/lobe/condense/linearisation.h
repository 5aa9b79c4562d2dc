// The state about which a pre-computed region is linearised (theory, section 14). At rest its tetrahedra
// follow Hooke's law. At another state of the body, forces are those of the non-linear model and stiffness is
// its tangent there.
#pragma once

#include "lobe/solve/tangent.h"

namespace lobe {

struct Linearisation {
  Mat3X<double> about = {};  // u₀, 3 × #vertices [m]; none: rest

  bool is_at_rest() const { return about.size() == 0; }
  RegionModel model() const { return is_at_rest() ? RegionModel::precomputed : RegionModel::nonlinear; }

  // The linearised forces on the corners of a tetrahedron: −∂W/∂u = constant − K u [N] at displacements u of
  // the corners [m].
  struct Forces {
    TetStiffness K;                         // [N/m]
    Eigen::Matrix<double, 12, 1> constant;  // f(u₀) + K u₀ [N]
  };
  Forces forces(const Elements& elements, Index tet, const Eigen::Vector4i& corners) const;
  // W(u₀) − f(u₀)·(u − u₀) + (u − u₀)·K (u − u₀)/2 [J]
  double energy(const Elements& elements, Index tet, const Mat34<double>& u) const;
};

}  // namespace lobe
