// The 10-node tetrahedron with straight edges (O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method,
// volume 1): functions of the corners λ_c (2λ_c − 1), of the edges 4 λ_i λ_j, in barycentric coordinates λ.
#pragma once

#include <array>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

using NodeGradients = Eigen::Matrix<double, 3, 10>;  // ∇N of each node [1/m]
using NodeValues = Eigen::Matrix<double, 10, 1>;     // N of each node

inline NodeValues quadratic_values(const Eigen::Vector4d& lambda) {
  NodeValues N;
  for (int c = 0; c < 4; ++c) N[c] = lambda[c] * (2 * lambda[c] - 1);
  for (int e = 0; e < 6; ++e) N[4 + e] = 4 * lambda[edge_corners[e][0]] * lambda[edge_corners[e][1]];
  return N;
}

inline NodeGradients quadratic_gradients(const Mat34<double>& alpha,  // ∇λ of each corner [1/m]
                                         const Eigen::Vector4d& lambda) {
  NodeGradients g;
  for (int c = 0; c < 4; ++c) g.col(c) = (4 * lambda[c] - 1) * alpha.col(c);
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = edge_corners[e];
    g.col(4 + e) = 4 * (lambda[i] * alpha.col(j) + lambda[j] * alpha.col(i));
  }
  return g;
}

// Four points of equal weight, exact to degree 2: the energy of linear elasticity is exact, and other
// energies keep the order of convergence.
inline std::array<Eigen::Vector4d, 4> quadratic_points() {
  constexpr double near = 0.58541019662496845446, far = 0.13819660112501051518;  // (5 + 3√5)/20, (5 − √5)/20
  std::array<Eigen::Vector4d, 4> points;
  for (int p = 0; p < 4; ++p) {
    points[p].setConstant(far);
    points[p][p] = near;
  }
  return points;
}

// Shares of a uniform load on a tetrahedron: −1/20 of each corner, 1/5 of each edge. Of one on a face: 1/3 of
// each of its edges.
inline constexpr double corner_share = -0.05, edge_share = 0.2, face_edge_share = 1.0 / 3;

}  // namespace lobe
