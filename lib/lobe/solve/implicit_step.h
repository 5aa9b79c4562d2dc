// One step of implicit dynamics: generalised-α (J. Chung, G. M. Hulbert, J. Appl. Mech. 60, 1993) on lumped
// masses,
//   m ((1 − α_m) a⁺ + α_m a + γ v_α) = f(u_α, t_α),          x_α = (1 − α_f) x⁺ + α_f x for u, v, t,
//   u⁺ = u + Δt v + Δt² ((½ − β) a + β a⁺),  v⁺ = v + Δt ((1 − γ_N) a + γ_N a⁺),
//   α_m = (2ρ − 1)/(ρ + 1), α_f = ρ/(ρ + 1), γ_N = ½ − α_m + α_f, β = ¼ (1 − α_m + α_f)².
// A step is solved as the minimum of the potential whose gradient this is, and never inverts a non-linear
// tetrahedron. The method is of second order and, for linear models, unconditionally stable. ρ is the
// spectral radius at high frequencies. ρ = 1 is the implicit midpoint rule (Newmark's average acceleration
// where f is linear), which conserves linear and angular momentum and, in linear models, energy. ρ < 1 damps
// what Δt cannot resolve.
#pragma once

#include <memory>
#include <optional>

#include "lobe/setup/boundary_conditions.h"
#include "lobe/solve/tangent.h"

namespace lobe {

struct DynamicState {
  Mat3X<double> u, v, a;  // 3 × #vertices [m], [m/s], [m/s²]
};

struct StepLoads {
  const std::vector<double>& mass;  // mass of each vertex [kg]
  Mat3X<double> external;           // loads at t_α, 3 × #vertices [N]
  Mat3X<double> prescribed;         // displacements of held components at the step's end, 3 × #vertices [m]
  double damping = 0;               // γ [1/s]
};

class ImplicitStep {
 public:
  ImplicitStep(double spectral_radius, SparseFactorMaker make_factor)  // ρ in [0, 1]
      : alpha_m_((2 * spectral_radius - 1) / (spectral_radius + 1)),
        alpha_f_(spectral_radius / (spectral_radius + 1)),
        make_factor_(std::move(make_factor)) {}

  // Call it after an edit of the mesh, of regions or of what is held. The elements must outlive the steps.
  void rebuild(const Elements& elements, const HeldVertices& held);
  bool is_built_on(const Elements& elements) const {
    return elements_ == &elements;
  }  // not if they have moved

  double load_time() const { return 1 - alpha_f_; }  // t_α = t + load_time() Δt

  // Returns false if Newton's method did not converge. The motion is then unchanged; a smaller step may work.
  bool step(const StepLoads& loads, double dt, DynamicState& motion);

 private:
  class Problem;

  double beta() const { return (1 - alpha_m_ + alpha_f_) * (1 - alpha_m_ + alpha_f_) / 4; }
  double gamma() const { return 0.5 - alpha_m_ + alpha_f_; }

  double alpha_m_, alpha_f_;
  SparseFactorMaker make_factor_;
  const Elements* elements_ = nullptr;
  std::optional<Unknowns> unknowns_;
  std::optional<Tangent> tangent_;
  std::unique_ptr<SparseFactor> factor_;
};

}  // namespace lobe
