#include "lobe/solve/static_solver.h"

#include <algorithm>
#include <cmath>

#include "lobe/sim/boundary_conditions.h"
#include "lobe/sim/check_setup.h"
#include "lobe/solve/floating.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

using Vector = Eigen::VectorXd;

HeldVertices held_vertices(const Setup& setup) {
  HeldVertices held;
  for (const PrescribedVertex& p : setup.prescribed)
    held.hold({p.vertex, HeldVertices::boundary, Vec3d::Zero(), p.displacement, p.axes});
  return held;
}

Mat3X<double> prescribed_displacements(const HeldVertices& held, Index vertices) {
  Mat3X<double> u = Mat3X<double>::Zero(3, vertices);
  for (const HeldVertices::Held& item : held.all())
    for (int axis = 0; axis < 3; ++axis)
      if (item.axes[axis]) u(axis, item.vertex) = item.goal[axis];
  return u;
}

// The equations of one setup: which displacements are unknown, what loads them.
class Equations {
 public:
  explicit Equations(const Setup& setup)
      : elements((check_setup(setup), setup)),
        unknowns(free_components(elements, held_vertices(setup))),
        prescribed(prescribed_displacements(held_vertices(setup), elements.topology.vertex_count())) {
    refuse_floating_pieces(elements, unknowns);
    loads = dead_loads(elements, setup.face_loads, setup.vertex_loads);
    for (Index v = 0; v < loads.cols(); ++v) loads.col(v) += lumped_mass(elements, v) * setup.gravity;
  }

  Elements elements;
  Unknowns unknowns;
  Mat3X<double> prescribed, loads;  // at full load [m], [N]
};

class Newton {
 public:
  Newton(const Equations& equations, const StaticOptions& options, StaticResult& result)
      : eq_(equations),
        options_(options),
        result_(result),
        tangent_(equations.elements, equations.unknowns),
        factor_(options.factor()) {
    factor_->analyse(tangent_.matrix());
    result.factor = factor_->name();
  }

  // Equilibrium at a load fraction, from the equilibrium u at another; u is changed only on success.
  bool equilibrate(double fraction, Mat3X<double>& u);
  const char* trouble() const { return trouble_; }  // of the last equilibrium that was not found

 private:
  bool follow_boundary(double fraction, Mat3X<double>& x, EnergyAndForces& e);
  bool factorise(const Mat3X<double>& u);
  double potential(const EnergyAndForces& e, const Mat3X<double>& u, double fraction) const {
    return e.energy - fraction * eq_.loads.cwiseProduct(u).sum();
  }
  bool line_search(double fraction, const Vector& residual, const Vector& step, Mat3X<double>& u,
                   EnergyAndForces& e);

  const Equations& eq_;
  const StaticOptions& options_;
  StaticResult& result_;
  Tangent tangent_;
  std::unique_ptr<SparseFactor> factor_;
  const char* trouble_ = "";
};

// The tangent, damped by growing multiples of its diagonal until it is positive definite.
bool Newton::factorise(const Mat3X<double>& u) {
  tangent_.update(u);
  bool positive = factor_->factorise(tangent_.matrix());
  if (!positive) ++result_.damped;
  const Vector diagonal = tangent_.matrix().diagonal();
  for (double shift = 1e-3; !positive && shift < 1e6; shift *= 4) {
    for (Index i = 0; i < eq_.unknowns.count; ++i)
      tangent_.matrix().valuePtr()[tangent_.diagonal(i)] = diagonal[i] + shift * std::abs(diagonal[i]);
    positive = factor_->factorise(tangent_.matrix());
  }
  result_.factor_nonzeros = factor_->nonzeros();
  if (!positive) trouble_ = "the tangent is singular there (a mechanism, or a collapsed tetrahedron)";
  return positive;
}

// Halves the step until no tetrahedron is inverted and the potential falls (or the residual does, where rounding hides
// the potential).
bool Newton::line_search(double fraction, const Vector& residual, const Vector& step, Mat3X<double>& u,
                         EnergyAndForces& e) {
  const double before = potential(e, u, fraction), slope = -residual.dot(step);
  const Mat3X<double> direction = eq_.unknowns.scatter(step);
  for (double length = 1; length > 1e-10; length /= 2) {
    const Mat3X<double> trial = u + length * direction;
    const EnergyAndForces at = energy_and_forces(eq_.elements, trial);
    result_.worst_tet = at.smallest_tet;
    trouble_ = "every step inverts it";
    if (!(at.smallest_volume_ratio > 0)) continue;
    trouble_ = "no step lowers the potential";
    const bool falls = potential(at, trial, fraction) <= before + 1e-4 * length * slope;
    const Vector r = eq_.unknowns.gather(fraction * eq_.loads + at.forces);
    if (!falls && !(r.norm() < 0.9 * residual.norm())) continue;
    u = trial;
    e = at;
    return true;
  }
  return false;
}

// Prescribed displacements of a load fraction, which the body first follows linearly.
bool Newton::follow_boundary(double fraction, Mat3X<double>& x, EnergyAndForces& e) {
  Mat3X<double> move = fraction * eq_.prescribed - x;
  for (Eigen::Index i = 0; i < move.size(); ++i)
    if (eq_.unknowns.number.data()[i] >= 0) move.data()[i] = 0;
  if (move.isZero(0)) return true;
  if (!factorise(x)) return false;
  const Vector residual = eq_.unknowns.gather(fraction * eq_.loads + e.forces) - tangent_.times(x, move);
  x += move + eq_.unknowns.scatter(factor_->solve(residual));
  e = energy_and_forces(eq_.elements, x);
  result_.worst_tet = e.smallest_tet;
  trouble_ = "the prescribed displacements invert it";
  return e.smallest_volume_ratio > 0;
}

bool Newton::equilibrate(double fraction, Mat3X<double>& u) {
  Mat3X<double> x = u;
  EnergyAndForces e = energy_and_forces(eq_.elements, x);
  if (!follow_boundary(fraction, x, e)) return false;
  for (int i = 0; i < options_.most_iterations; ++i) {
    const Mat3X<double> all = fraction * eq_.loads + e.forces;
    const Vector residual = eq_.unknowns.gather(all);
    const double scale =
        std::max(fraction * eq_.loads.norm(), all.norm());  // loads, or the reactions where held
    const double relative = scale > 0 ? residual.norm() / scale : 0;
    if (relative <= options_.tolerance) {
      u = x;
      result_.residual = relative;
      result_.energy = e.energy;
      result_.smallest_volume_ratio = e.smallest_volume_ratio;
      result_.worst_tet = e.smallest_tet;
      return true;
    }
    ++result_.iterations;
    if (!factorise(x) || !line_search(fraction, residual, factor_->solve(residual), x, e)) return false;
  }
  trouble_ = "Newton's method did not converge";
  return false;
}

}  // namespace

StaticResult solve_static(const Setup& setup, const StaticOptions& options) {
  const Equations equations(setup);
  StaticResult result;
  result.unknowns = equations.unknowns.count;
  result.u.setZero(3, equations.elements.topology.vertex_count());
  Newton newton(equations, options, result);
  double step = 1;
  while (result.load_fraction < 1) {
    const double fraction = std::min(1.0, result.load_fraction + step);
    if (newton.equilibrate(fraction, result.u)) {
      result.load_fraction = fraction;
      ++result.load_steps;
      step *= 2;
      if (options.progress) options.progress(fraction);
      continue;
    }
    step = std::min(step, 1 - result.load_fraction) / 2;
    if (step >= options.smallest_load_step) continue;
    result.reason = "no equilibrium beyond " + std::to_string(100 * result.load_fraction) +
                    " % of the load; tetrahedron " + std::to_string(result.worst_tet) +
                    " is the most compressed, and " + newton.trouble() +
                    ": a volume_penalty, smaller loads or a finer mesh there may help";
    return result;
  }
  result.converged = true;
  return result;
}

}  // namespace lobe
