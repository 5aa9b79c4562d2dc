// Bodies of edge-smoothed tetrahedra beside others, and their stiffness as one dense matrix.
#pragma once

#include <Eigen/LU>
#include <algorithm>

#include "lobe/solve/tangent.h"
#include "support.h"

namespace lobe::test {

// Four materials in layers: smoothed, plain, smoothed and neo-Hookean, smoothed with fibres; with volume term
// and guard. With nodal pressure all four have some of it.
inline Setup mixed_setup(const TetMesh& mesh, bool nodal_pressure) {
  Setup setup = smoothed(setup_of(mesh));
  setup.materials.assign(4, setup.materials[0]);
  setup.materials[1] = {7e4, 2e4, 1100};
  setup.materials[2].law = MaterialLaw::neo_hookean;
  setup.materials[3].fibre = {3e3, 8e3, 5e4};
  const double shares[]{1, 0.5, 0.6, 0.7};
  for (std::size_t m = 0; m < 4 && nodal_pressure; ++m) setup.materials[m].nodal_pressure = shares[m];
  const double size = mesh.points.row(0).maxCoeff();
  setup.mesh.fibres = random_displacement(mesh.tet_count(), 1).colwise().normalized();
  for (Index t = 0; t < mesh.tet_count(); ++t)
    setup.material_of[t] = std::uint16_t(std::clamp(int(4 * barycentre(mesh, t).x() / size), 0, 3));
  setup.volume_penalty = 1e5;
  setup.guard_below = 0.5;
  return setup;
}

// ∂²W/∂u² of the unknowns, with nodal pressures eliminated.
inline Eigen::MatrixXd dense_stiffness(const Tangent& tangent, Index unknowns) {
  const Eigen::MatrixXd A = Eigen::MatrixXd(tangent.matrix()).selfadjointView<Eigen::Lower>();
  const Index pressures = static_cast<Index>(A.rows()) - unknowns;
  if (pressures == 0) return A;
  const Eigen::MatrixXd G = A.bottomLeftCorner(pressures, unknowns),
                        C = -A.bottomRightCorner(pressures, pressures);
  return A.topLeftCorner(unknowns, unknowns) + G.transpose() * C.inverse() * G;
}

}  // namespace lobe::test
