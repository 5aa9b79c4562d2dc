// How a static equilibrium changes with a number θ that its setup depends on, by the theorem on implicit
// functions: the residual r(u, θ) stays zero, so that K ∂u/∂θ = ∂r/∂θ at fixed u, with the tangent K. One
// factor serves all numbers.
#pragma once

#include <functional>
#include <memory>

#include "lobe/solve/static_equations.h"
#include "lobe/solve/tangent.h"

namespace lobe {

// Gives the setup at a value of θ: on the same mesh, with the same components held at the same displacements.
using SetupAt = std::function<Setup(double value)>;

struct StaticDerivative {
  Mat3X<double> u;          // ∂u/∂θ, 3 × #vertices [m per unit of θ]
  Mat3X<double> reactions;  // derivatives of StaticResult::reactions, 3 × #vertices [N per unit of θ]
};

class StaticSensitivity {
 public:
  // `u` is the equilibrium of the setup, 3 × #vertices [m]. Throws InputError if it is not stable.
  StaticSensitivity(const Setup& setup, const Mat3X<double>& u, const SparseFactorMaker& factor = make_ldlt);

  // Returns the derivative at the value that the setup has. Differences over `step` are taken of forces at
  // given displacements, which are almost linear in moduli, and of no solution.
  StaticDerivative by(const SetupAt& at, double value, double step) const;

  // The displacements that small forces cause beside the loads, 3 × #vertices [N] to [m].
  Mat3X<double> response(const Mat3X<double>& forces) const;
  // The displacements of all vertices if those that are held are moved by w, which is zero elsewhere.
  // Pressures are as before.
  Mat3X<double> response_to_move(const Mat3X<double>& w) const;  // 3 × #vertices [m]

 private:
  Eigen::VectorXd solve(const Eigen::VectorXd& forces) const;

  Setup setup_;
  Mat3X<double> u_;
  Elements elements_;
  StaticEquations equations_;
  Tangent tangent_;
  std::unique_ptr<SparseFactor> factor_;
};

}  // namespace lobe
