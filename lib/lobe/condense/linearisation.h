// The state about which a pre-computed region is linearised (theory, section 14). At rest its tetrahedra
// follow Hooke's law. At another state of the body, forces are those of the non-linear model and stiffness is
// its tangent there. The region is a sum of elements: plain tetrahedra, what edge-smoothed ones have by
// themselves, and smoothing domains (region/smoothed_edges.h).
#pragma once

#include "lobe/solve/tangent.h"

namespace lobe {

struct Linearisation {
  Mat3X<double> about = {};  // u₀, 3 × #vertices [m]; none: rest

  bool is_at_rest() const { return about.size() == 0; }
  RegionModel model() const { return is_at_rest() ? RegionModel::precomputed : RegionModel::nonlinear; }

  // Whether a tetrahedron has a part of its own, besides its domains.
  bool is_element(const Elements& elements, Index tet) const {
    return !is_at_rest() || !elements.elastic_of(tet).is_smoothed();
  }

  // The linearised forces on the vertices of an element: −∂W/∂u = constant − K u [N] at displacements u of
  // these vertices [m].
  template <int size>  // three times the number of vertices
  struct Forces {
    Eigen::Matrix<double, size, size> K;      // [N/m]
    Eigen::Matrix<double, size, 1> constant;  // f(u₀) + K u₀ [N]
  };
  Forces<12> forces(const Elements& elements, Index tet, const Eigen::Vector4i& corners) const;
  Forces<Eigen::Dynamic> forces(const Elements& elements, const SmoothedEdge& domain) const;
  // The forces at displacements u of these vertices, both 3 × #vertices [m], [N].
  Mat34<double> forces_at(const Elements& elements, Index tet, const Mat34<double>& u) const;
  Mat3X<double> forces_at(const Elements& elements, const SmoothedEdge& domain, const Mat3X<double>& u) const;
  // W(u₀) − f(u₀)·(u − u₀) + (u − u₀)·K (u − u₀)/2 [J]
  double energy(const Elements& elements, Index tet, const Mat34<double>& u) const;
  double energy(const Elements& elements, const SmoothedEdge& domain, const Mat3X<double>& u) const;
};

}  // namespace lobe
