#include "lobe/solve/static_solver.h"

#include "lobe/setup/check_setup.h"
#include "lobe/setup/pressures.h"
#include "lobe/solve/floating.h"
#include "lobe/solve/static_equations.h"

namespace lobe {
namespace {

// The tetrahedra with four nodes that everything else in lobe has.
class LinearTets : public Discretisation {
 public:
  LinearTets(const Elements& elements, const Unknowns& unknowns)
      : elements_(elements), tangent_(elements, unknowns), unknowns_(unknowns.count) {}

  EnergyAndForces energy_and_forces(const Mat3X<double>& u) const override {
    return lobe::energy_and_forces(elements_, tangent_.averages(), u);
  }
  void update(const Mat3X<double>& u) override { tangent_.update(u); }
  void add_diagonal(const Mat3X<double>& k) override { tangent_.add_diagonal(k); }
  std::unique_ptr<SparseFactor> make_factor(const SparseFactorMaker& wanted) const override {
    return tangent_.make_factor(wanted);
  }
  bool factorise(SparseFactor& factor, bool& damped) override { return tangent_.factorise(factor, damped); }
  bool is_stable(SparseFactor& factor) override {
    const SparseFactor::Matrix& matrix = tangent_.matrix();
    return factor.factorise(matrix, matrix.rows() - unknowns_);  // pressures are negative
  }
  Eigen::VectorXd solve(const SparseFactor& factor, const Eigen::VectorXd& forces) const override {
    return tangent_.solve(factor, forces);
  }
  Eigen::VectorXd solve(const SparseFactor& factor, const Eigen::VectorXd& forces, const Mat3X<double>& u,
                        const Mat3X<double>& w) const override {
    return tangent_.solve(factor, forces, u, w);
  }

 private:
  const Elements& elements_;
  Tangent tangent_;
  Index unknowns_;
};

constexpr int most_rounds = 60;           // of equilibria under pressure
constexpr double pressure_change = 1e-9;  // between the last two, relative to all loads

double norm_of_unknown(const StaticEquations& equations, Mat3X<double> forces) {
  equations.unknowns.clear_prescribed(forces);
  return forces.norm();
}

// Pressure turns with the walls: the equilibrium is found again and again under the forces that it has at the
// last one, until they stay. Each round reduces their change by about the pressure over Young's modulus.
StaticResult solve_under_pressure(const Setup& setup, const Elements& elements, StaticEquations equations,
                                  Discretisation& body, StaticOptions options) {
  const Mat3X<double> dead = equations.loads;
  const auto loads_at = [&](const Mat3X<double>& u) {
    Mat3X<double> loads = dead;
    add_pressures(setup.pressures, elements, 1, u, loads);
    return loads;
  };
  Mat3X<double> start = options.start ? *options.start : Mat3X<double>::Zero(3, dead.cols()).eval();
  StaticResult result;
  int iterations = 0, load_steps = 0;
  for (int round = 0; round < most_rounds; ++round) {
    equations.loads = loads_at(start);
    if (round > 0) options.start = &start;
    result = find_equilibrium(equations, body, options);
    result.iterations = iterations += result.iterations;
    result.load_steps = load_steps += result.load_steps;
    if (!result.converged) return result;
    const Mat3X<double> change = loads_at(result.u) - equations.loads;
    if (norm_of_unknown(equations, change) <= pressure_change * equations.loads.norm()) return result;
    start = result.u;
  }
  result.converged = false;
  result.reason = "the pressure turns with the walls so much that no equilibrium was found in " +
                  std::to_string(most_rounds) + " rounds: a lower pressure or a stiffer wall may have one";
  return result;
}

}  // namespace

StaticResult solve_static(const Setup& setup, const StaticOptions& options) {
  check_setup(setup, {Option::static_solution});
  const Elements elements(setup);
  const StaticEquations equations = static_equations(setup, elements);
  refuse_floating_pieces(elements, equations.unknowns, equations.stiffness);
  LinearTets body(elements, equations.unknowns);
  if (!setup.pressures.empty()) return solve_under_pressure(setup, elements, equations, body, options);
  return find_equilibrium(equations, body, options);
}

}  // namespace lobe
