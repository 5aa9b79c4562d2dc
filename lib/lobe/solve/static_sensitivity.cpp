#include "lobe/solve/static_sensitivity.h"

#include "lobe/error.h"
#include "lobe/setup/pressures.h"

namespace lobe {
namespace {

constexpr int most_turns = 200;      // of the change of pressure forces
constexpr double last_turn = 1e-10;  // between two rounds, relative

struct Balance {
  Mat3X<double> residual;   // 3 × #vertices, zero where displacements are given [N]
  Mat3X<double> reactions;  // as StaticResult has them [N]
};

Balance balance(const Setup& setup, const Mat3X<double>& u) {
  const Elements elements(setup);
  const StaticEquations equations = static_equations(setup, elements);
  Mat3X<double> forces = equations.loads + energy_and_forces(elements, u).forces;
  add_pressures(setup.pressures, elements, 1, u, forces);
  Balance found{forces, -forces};
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (equations.unknowns.number.data()[i] >= 0) found.reactions.data()[i] = 0;
  if (equations.stiffness.cols() > 0) {
    const Mat3X<double> springs = equations.stiffness.cwiseProduct(equations.spring_targets - u);
    found.residual += springs;
    found.reactions += springs;
  }
  equations.unknowns.clear_prescribed(found.residual);
  return found;
}

}  // namespace

StaticSensitivity::StaticSensitivity(const Setup& setup, const Mat3X<double>& u,
                                     const SparseFactorMaker& factor)
    : setup_(setup),
      u_(u),
      elements_(setup_),
      equations_(static_equations(setup_, elements_)),
      tangent_(elements_, equations_.unknowns) {
  tangent_.update(u);
  if (equations_.stiffness.cols() > 0) tangent_.add_diagonal(equations_.stiffness);
  factor_ = tangent_.make_factor(factor);
  bool damped = false;
  if (!tangent_.factorise(*factor_, damped) || damped)
    throw InputError("equilibrium", "is not stable, so that a small change of the scene has no small effect");
}

// Pressures turn with the walls. The tangent leaves that out, and it is smaller than K by about the pressure
// over Young's modulus: it is added to the forces again and again.
Eigen::VectorXd StaticSensitivity::solve(const Eigen::VectorXd& forces) const {
  Eigen::VectorXd x = tangent_.solve(*factor_, forces);
  if (setup_.pressures.empty()) return x;
  for (int round = 0; round < most_turns; ++round) {
    const Mat3X<double> way = equations_.unknowns.scatter(x);
    const double size = way.cwiseAbs().maxCoeff();
    if (!(size > 0)) return x;
    const double scale = 1e-3 * std::cbrt(elements_.volume(0)) / size;  // any: forces are of second order
    Mat3X<double> turned = Mat3X<double>::Zero(3, way.cols());
    add_pressures(setup_.pressures, elements_, 0.5 / scale, Mat3X<double>(u_ + scale * way), turned);
    add_pressures(setup_.pressures, elements_, -0.5 / scale, Mat3X<double>(u_ - scale * way), turned);
    const Eigen::VectorXd next =
        tangent_.solve(*factor_, Eigen::VectorXd(forces + equations_.unknowns.gather(turned)));
    const bool is_last = (next - x).norm() <= last_turn * next.norm();
    x = next;
    if (is_last) return x;
  }
  throw InputError("pressures",
                   "turn with the walls so much that the effect of a small change was not found");
}

Mat3X<double> StaticSensitivity::response(const Mat3X<double>& forces) const {
  return equations_.unknowns.scatter(solve(equations_.unknowns.gather(forces)));
}

Mat3X<double> StaticSensitivity::response_to_move(const Mat3X<double>& w) const {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(equations_.unknowns.count);
  return w + equations_.unknowns.scatter(tangent_.solve(*factor_, none, u_, w));
}

StaticDerivative StaticSensitivity::by(const SetupAt& at, double value, double step) const {
  const Setup more = at(value + step), less = at(value - step);
  const Mat3X<double> slope = (balance(more, u_).residual - balance(less, u_).residual) / (2 * step);
  StaticDerivative derivative;
  derivative.u = equations_.unknowns.scatter(solve(equations_.unknowns.gather(slope)));
  const Mat3X<double> way = step * derivative.u;
  derivative.reactions = (balance(more, u_ + way).reactions - balance(less, u_ - way).reactions) / (2 * step);
  return derivative;
}

}  // namespace lobe
