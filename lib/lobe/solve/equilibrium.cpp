#include "lobe/solve/equilibrium.h"

#include <algorithm>

#include "lobe/solve/newton.h"
#include "lobe/text.h"

namespace lobe {
namespace {

std::string most_compressed(Index tet) {  // for messages; −1: none is known
  return tet < 0 ? "" : "tetrahedron " + std::to_string(tet) + " is the most compressed, and ";
}

// Equilibrium at one share of the loads and prescribed displacements.
class Equilibrium : public NewtonProblem {
 public:
  Equilibrium(const StaticEquations& equations, Discretisation& body, const StaticOptions& options,
              StaticResult& result)
      : eq_(equations),
        body_(body),
        options_(options),
        result_(result),
        factor_(body.make_factor(options.factor)) {
    result.factor = factor_->name();
  }

  // Goes on from result.u, the equilibrium at another fraction. The result changes only on success.
  bool find(double fraction);
  const char* reason() const { return reason_; }  // of the last equilibrium that was not found

  NewtonPoint at(const Mat3X<double>& u) const override;
  bool direction(const NewtonPoint& at, Mat3X<double>& direction) override;

 private:
  bool factorise(const Mat3X<double>& u);
  bool follow_boundary(NewtonPoint& point);
  Mat3X<double> spring_forces(const Mat3X<double>& u) const;
  void finish(const Mat3X<double>& u);

  const StaticEquations& eq_;
  Discretisation& body_;
  const StaticOptions& options_;
  StaticResult& result_;
  std::unique_ptr<SparseFactor> factor_;
  double fraction_ = 0;
  const char* reason_ = "";
};

Mat3X<double> Equilibrium::spring_forces(const Mat3X<double>& u) const {
  if (eq_.stiffness.cols() == 0) return Mat3X<double>::Zero(3, u.cols());
  return eq_.stiffness.cwiseProduct(fraction_ * eq_.spring_targets - u);
}

NewtonPoint Equilibrium::at(const Mat3X<double>& u) const {
  EnergyAndForces e = body_.energy_and_forces(u);
  NewtonPoint point;
  point.u = u;
  point.potential = e.energy - fraction_ * eq_.loads.cwiseProduct(u).sum();
  point.residual = fraction_ * eq_.loads + e.forces;
  if (eq_.stiffness.cols() > 0) {
    const Mat3X<double> springs = spring_forces(u);
    point.potential += springs.cwiseProduct(fraction_ * eq_.spring_targets - u).sum() / 2;
    point.residual += springs;
    point.scale = springs.norm();
  }
  point.scale = std::max({point.scale, fraction_ * eq_.loads.norm(),
                          point.residual.norm()});  // loads, or the reactions where held
  eq_.unknowns.clear_prescribed(point.residual);
  point.smallest_volume_ratio = e.smallest_volume_ratio;
  point.smallest_tet = e.smallest_tet;
  return point;
}

bool Equilibrium::factorise(const Mat3X<double>& u) {
  bool damped = false;
  body_.update(u);
  if (eq_.stiffness.cols() > 0) body_.add_diagonal(eq_.stiffness);
  const bool positive = body_.factorise(*factor_, damped);
  result_.damped += damped;
  result_.factor_nonzeros = factor_->nonzeros();
  return positive;
}

bool Equilibrium::direction(const NewtonPoint& at, Mat3X<double>& direction) {
  if (!factorise(at.u)) return false;
  direction = eq_.unknowns.scatter(body_.solve(*factor_, eq_.unknowns.gather(at.residual)));
  return true;
}

// Moves the boundary to the prescribed displacements of the load fraction; the body follows linearly at
// first.
bool Equilibrium::follow_boundary(NewtonPoint& point) {
  Mat3X<double> move = fraction_ * eq_.prescribed - point.u;
  for (Eigen::Index i = 0; i < move.size(); ++i)
    if (eq_.unknowns.number.data()[i] >= 0) move.data()[i] = 0;
  if (move.isZero(0)) return true;
  reason_ = "the tangent is singular there (a mechanism, or a collapsed tetrahedron)";
  if (!factorise(point.u)) return false;
  const Eigen::VectorXd residual = eq_.unknowns.gather(point.residual);
  point = at(point.u + move + eq_.unknowns.scatter(body_.solve(*factor_, residual, point.u, move)));
  reason_ = "the prescribed displacements invert it";
  return point.smallest_volume_ratio > 0;
}

// What the solution says besides displacements.
void Equilibrium::finish(const Mat3X<double>& u) {
  const EnergyAndForces e = body_.energy_and_forces(u);
  result_.energy = e.energy;
  result_.smallest_volume_ratio = e.smallest_volume_ratio;
  result_.reactions = -(fraction_ * eq_.loads + e.forces);
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (eq_.unknowns.number.data()[i] >= 0) result_.reactions.data()[i] = 0;
  result_.reactions += spring_forces(u);
}

bool Equilibrium::find(double fraction) {
  fraction_ = fraction;
  NewtonPoint point = at(result_.u);
  if (!follow_boundary(point)) {
    result_.worst_tet = point.smallest_tet;
    return false;
  }
  const NewtonResult newton = minimise(*this, point, options_.tolerance, options_.most_iterations);
  result_.iterations += newton.iterations;
  result_.worst_tet = point.smallest_tet;
  reason_ = newton.reason;
  if (!newton.converged) return false;
  result_.u = point.u;
  result_.residual = point.scale > 0 ? point.residual.norm() / point.scale : 0;
  finish(point.u);
  return true;
}

}  // namespace

StaticResult find_equilibrium(const StaticEquations& equations, Discretisation& body,
                              const StaticOptions& options) {
  StaticResult result;
  result.unknowns = equations.unknowns.count;
  result.u.setZero(3, equations.loads.cols());
  result.reactions = result.u;
  Equilibrium equilibrium(equations, body, options, result);
  if (options.start) {
    result.u = *options.start;
    if (equilibrium.find(1))
      result.load_fraction = result.load_steps = 1;
    else
      result.u.setZero();
  }
  double step = 1;
  while (result.load_fraction < 1) {
    const double fraction = std::min(1.0, result.load_fraction + step);
    if (equilibrium.find(fraction)) {
      result.load_fraction = fraction;
      ++result.load_steps;
      step *= 2;
      if (options.progress) options.progress(fraction);
      continue;
    }
    step = std::min(step, 1 - result.load_fraction) / 2;
    if (step >= options.smallest_load_step) continue;
    result.reason = "no equilibrium beyond " + rounded(100 * result.load_fraction) + " % of the load; " +
                    most_compressed(result.worst_tet) + equilibrium.reason() +
                    ": a volume_penalty, smaller loads or a finer mesh there may help";
    return result;
  }
  result.converged = true;
  return result;
}

}  // namespace lobe
