// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/rest_time_step.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lobe::meshing {

// K_ii = Σ V [(λ + μ) α⊗α + μ (α·α) I] and m_i = Σ ρ V / 4 over the tetrahedra at vertex i.
double rest_time_step(const TetMesh& mesh, double lambda, double mu, double density) {
  std::vector<Mat3<double>> stiffness(mesh.vertex_count(), Mat3<double>::Zero());
  std::vector<double> mass(mesh.vertex_count(), 0);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    const Mat34<double> x = tet_points(mesh, t);
    const double volume = signed_volume(x);
    Mat3<double> edges;
    edges << x.col(1) - x.col(0), x.col(2) - x.col(0), x.col(3) - x.col(0);
    const Mat3<double> gradients = edges.inverse();  // row k: α of corner k + 1
    for (int k = 0; k < 4; ++k) {
      const Vec3d alpha = k == 0 ? Vec3d(-gradients.colwise().sum()) : Vec3d(gradients.row(k - 1));
      const Index v = mesh.tets(k, t);
      stiffness[v] += volume * ((lambda + mu) * alpha * alpha.transpose() +
                                mu * alpha.squaredNorm() * Mat3<double>::Identity());
      mass[v] += density * volume / 4;
    }
  }
  double largest = 0;  // ω² [1/s²]
  for (Index i = 0; i < mesh.vertex_count(); ++i) {
    if (mass[i] <= 0) continue;  // belongs to no tetrahedron
    const Eigen::SelfAdjointEigenSolver<Mat3<double>> solver(stiffness[i], Eigen::EigenvaluesOnly);
    largest = std::max(largest, solver.eigenvalues()[2] / mass[i]);
  }
  return largest > 0 ? 2 / std::sqrt(largest) : 0;
}

}  // namespace lobe::meshing
