// Displacements and velocities of a body, and the scratch data of a step.
#pragma once

#include <cmath>
#include <tuple>

#include "lobe/body/integrator.h"
#include "lobe/mesh/vertex_columns.h"

namespace lobe {

template <class Real>
struct State {
  Mat3X<Real> u;    // 3 × #vertices, displacement [m]
  Mat3X<Real> v;    // 3 × #vertices, velocity [m/s]
  double time = 0;  // [s]
  // By how much v is older than u [s]: half a step after a step, 0 where motion starts.
  double velocity_lag = 0;

  bool is_valid() const {
    return u.allFinite() && v.allFinite() && std::isfinite(time) && velocity_lag >= 0 &&
           std::isfinite(velocity_lag);
  }
  static constexpr auto fields = std::tuple(&State::u, &State::v, &State::time, &State::velocity_lag);
};

// A view of the present state of a world. It becomes invalid with the next cut.
template <class Real>
struct StateView {
  Eigen::Map<const Mat3X<Real>> u, v;
  double time = 0, velocity_lag = 0;
  operator State<Real>() const { return {u, v, time, velocity_lag}; }
};

// Displacements and velocities of the nodes of reduced regions (lattice/embedding.h). There are none without
// such a region.
template <class Real>
struct Nodes {
  Mat3X<Real> u = Mat3X<Real>(3, 0), v = Mat3X<Real>(3, 0);  // 3 × #nodes [m], [m/s]
};

// A State whose columns may grow when a cut adds vertices.
template <class Real>
struct StateColumns {
  VertexColumns<Mat3X<Real>> u, v;  // [m], [m/s]
  Nodes<Real> nodes;
  double time = 0, velocity_lag = 0;  // [s]
};

// Speeds of the last step [m/s].
struct Speeds {
  double fastest = 0;    // speed of the fastest free vertex
  double reversing = 0;  // speed of the fastest vertex that turned back (integrator.h)
  double driven = 0;     // speed of the fastest held vertex
};

template <class Real>
struct Motion : StateColumns<Real> {
  // Scratch of a step:
  VertexColumns<Mat3X<Real>> forces;  // [N]
  Reversals reversals;                // turns of each vertex since the frame began
  Mat3X<Real> node_forces;            // 3 × #nodes [N]
  Reversals node_turns;
  Speeds speeds;
  double longest_move = 0;  // the move of a vertex in a step beyond which the step is trouble [m]

  void extend(Index vertices) {
    this->u.extend(vertices);
    this->v.extend(vertices);
    forces.extend(vertices);
    reversals.resize(std::size_t(vertices));
  }
};

}  // namespace lobe
