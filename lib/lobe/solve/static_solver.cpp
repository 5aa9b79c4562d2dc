#include "lobe/solve/static_solver.h"

#include "lobe/setup/boundary_conditions.h"
#include "lobe/setup/check_setup.h"
#include "lobe/solve/equilibrium.h"
#include "lobe/solve/floating.h"

namespace lobe {
namespace {

Mat3X<double> prescribed_displacements(const HeldVertices& held, Index vertices) {
  Mat3X<double> u = Mat3X<double>::Zero(3, vertices);
  for (const HeldVertices::Held& item : held.all())
    for (int axis = 0; axis < 3; ++axis)
      if (item.axes[axis]) u(axis, item.vertex) = item.goal[axis];
  return u;
}

StaticEquations equations_of(const Setup& setup, const Elements& elements) {
  const HeldVertices held = held_by(setup.prescribed);
  StaticEquations equations{free_components(elements, held),
                            prescribed_displacements(held, elements.topology.vertex_count()),
                            dead_loads(elements, setup.face_loads, setup.vertex_loads)};
  for (Index v = 0; v < equations.loads.cols(); ++v)
    equations.loads.col(v) += lumped_mass(elements, v) * setup.gravity;
  return equations;
}

// The tetrahedra with four nodes that everything else in lobe has.
class LinearTets : public Discretisation {
 public:
  LinearTets(const Elements& elements, const Unknowns& unknowns)
      : elements_(elements), tangent_(elements, unknowns) {}

  EnergyAndForces energy_and_forces(const Mat3X<double>& u) const override {
    return lobe::energy_and_forces(elements_, tangent_.averages(), u);
  }
  void update(const Mat3X<double>& u) override { tangent_.update(u); }
  void add_diagonal(const Mat3X<double>& k) override { tangent_.add_diagonal(k); }
  std::unique_ptr<SparseFactor> make_factor(const SparseFactorMaker& wanted) const override {
    return tangent_.make_factor(wanted);
  }
  bool factorise(SparseFactor& factor, bool& damped) override { return tangent_.factorise(factor, damped); }
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
};

}  // namespace

StaticResult solve_static(const Setup& setup, const StaticOptions& options) {
  check_setup(setup, {Option::static_solution});
  const Elements elements(setup);
  const StaticEquations equations = equations_of(setup, elements);
  refuse_floating_pieces(elements, equations.unknowns);
  LinearTets body(elements, equations.unknowns);
  return find_equilibrium(equations, body, options);
}

}  // namespace lobe
