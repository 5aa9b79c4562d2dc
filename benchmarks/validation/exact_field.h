// A manufactured displacement, and the loads in closed form that make it an equilibrium. After the sympy file
// of Caribou's Validation/manufactured_solution: u = a (z eˣ, x eʸ, y eᶻ), X − centre = (x, y, z).
#pragma once

#include <array>

#include "lobe/fem/body.h"

namespace lobe::validation {

struct ExactField {
  double amplitude = 1e-3;  // a
  Vec3d centre = Vec3d::Zero();

  Vec3d displacement(const Vec3d& X) const;
  Mat3<double> gradient(const Vec3d& X) const;                             // H = ∇u
  std::array<Mat3<double>, 3> gradient_derivatives(const Vec3d& X) const;  // ∂H/∂X_j
};

struct Law {
  RegionModel model = RegionModel::nonlinear;
  double lambda = 1.25, mu = 1, volume_penalty = 0;  // [Pa]
  FibreModuli<double> fibre{};                       // [Pa]
  Vec3d turn{0.4, -0.3, 0.5};                        // of the fibres per length [rad/m]

  // The fibre turns with the angle turn·X in a plane that lies askew: a = cos (0.6, 0, 0.8) + sin (0, 1, 0).
  Vec3d direction(const Vec3d& X) const;
  Mat3<double> stress(const Mat3<double>& H, const Vec3d& X) const;  // P [Pa]
  // ∂P/∂X_j where ∂H/∂X_j = dH: λ tr(dH) I + μ (dH + dHᵀ), or dH S + F (λ tr(dE) I + 2μ dE) with
  // dE = sym(Fᵀ dH); of the volume term 2κ|v| (cof F : dH) cof F + κ v|v| d(cof F); of fibres
  // S_fibre(dE) and what comes from ∂(a⊗a)/∂X_j.
  Mat3<double> stress_derivative(const Mat3<double>& H, const Mat3<double>& dH, const Vec3d& X, int j) const;
};

// b = −Div P, b_i = −Σ_j ∂P_ij/∂X_j [N/m³]
Vec3d body_force(const ExactField& field, const Law& law, const Vec3d& X);

}  // namespace lobe::validation
