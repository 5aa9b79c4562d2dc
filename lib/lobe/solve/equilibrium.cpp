#include "lobe/solve/equilibrium.h"

#include <algorithm>
#include <cmath>

#include "lobe/solve/newton.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr int most_bisections = 24;
// St Venant-Kirchhoff has no stable state below the stretch 1/√3; slender bodies buckle at small strains.
constexpr double least_volume_ratio = 0.7;

constexpr double near_limit = 0.12;     // of the load at which stability is lost
constexpr int most_tries_at_limit = 3;  // of equilibria beyond it

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
  // The fraction at which the tangent ceases to be positive definite, if the body goes on from result.u as it
  // begins to. 0: it does not up to `fraction`, or a tetrahedron collapses first. Costs some dozen factors.
  double loss_of_stability(double fraction);
  const char* reason() const { return reason_; }  // of the last equilibrium that was not found

  NewtonPoint at(const Mat3X<double>& u) const override;
  bool direction(const NewtonPoint& at, Mat3X<double>& direction) override;

 private:
  bool factorise(const Mat3X<double>& u);
  bool follow_boundary(NewtonPoint& point);
  void show_progress(const NewtonPoint& at) const;
  bool is_stable(const Mat3X<double>& u);
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
  show_progress(at);
  if (!factorise(at.u)) return false;
  direction = eq_.unknowns.scatter(body_.solve(*factor_, eq_.unknowns.gather(at.residual)));
  return true;
}

// The residual falls from its scale to the tolerance.
void Equilibrium::show_progress(const NewtonPoint& at) const {
  if (!options_.progress || !(at.scale > 0)) return;
  const double share = std::log(at.residual.norm() / at.scale) / std::log(options_.tolerance);
  options_.progress(result_.load_fraction +
                    std::clamp(share, 0.0, 1.0) * (fraction_ - result_.load_fraction));
}

bool Equilibrium::is_stable(const Mat3X<double>& u) {
  body_.update(u);
  if (eq_.stiffness.cols() > 0) body_.add_diagonal(eq_.stiffness);
  return body_.is_stable(*factor_);
}

double Equilibrium::loss_of_stability(double fraction) {
  fraction_ = fraction;
  const NewtonPoint start = at(result_.u);
  if (!is_stable(start.u)) return 0;
  Mat3X<double> way = fraction * eq_.prescribed - start.u;
  for (Eigen::Index i = 0; i < way.size(); ++i)
    if (eq_.unknowns.number.data()[i] >= 0) way.data()[i] = 0;
  const Eigen::VectorXd residual = eq_.unknowns.gather(start.residual);
  way += eq_.unknowns.scatter(body_.solve(*factor_, residual, start.u, way));
  double stable = 0, unstable = 1;
  if (is_stable(start.u + way)) return 0;
  for (int i = 0; i < most_bisections && unstable - stable > 0.01 * unstable; ++i) {
    const double middle = stable > 0 ? (stable + unstable) / 2 : unstable / 4;
    (is_stable(start.u + middle * way) ? stable : unstable) = middle;
  }
  const bool collapses =
      body_.energy_and_forces(start.u + unstable * way).smallest_volume_ratio < least_volume_ratio;
  return collapses ? 0 : result_.load_fraction + unstable * (fraction - result_.load_fraction);
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

std::string reason_of(const StaticResult& result, const char* why) {
  const std::string last = rounded(100 * result.load_fraction) + " % of the load";
  if (result.buckling > 0)
    return "the body loses its stability at about " + rounded(100 * result.buckling) +
           " % of the load (buckling), and no equilibrium was found beyond " + last +
           ": load it less, or hold it where it gives way";
  return "no equilibrium beyond " + last + "; " + most_compressed(result.worst_tet) + why +
         ": a volume_penalty, smaller loads or a finer mesh there may help";
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
  for (int failures = 0; result.load_fraction < 1;) {
    const double fraction = std::min(1.0, result.load_fraction + step);
    const int damped_before = result.damped;
    if (equilibrium.find(fraction)) {
      result.load_fraction = fraction;
      ++result.load_steps;
      step *= 2;
      failures = 0;
      if (options.progress) options.progress(fraction);
      continue;
    }
    step = std::min(step, 1 - result.load_fraction) / 2;
    const double limit = result.damped > damped_before ? equilibrium.loss_of_stability(fraction) : 0;
    if (limit > 0 && (result.buckling == 0 || result.load_fraction <= result.buckling))
      result.buckling = limit;
    if (limit > 0 && limit - result.load_fraction > near_limit * limit)  // goes nearer first
      step = std::min(step, (1 - near_limit / 2) * (limit - result.load_fraction));
    const bool is_far_enough = limit > 0 && ++failures == most_tries_at_limit;
    if (!is_far_enough && step >= options.smallest_load_step * (limit > 0 ? limit : 1)) continue;
    result.reason = reason_of(result, equilibrium.reason());
    return result;
  }
  result.converged = true;
  return result;
}

}  // namespace lobe
