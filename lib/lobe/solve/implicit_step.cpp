#include "lobe/solve/implicit_step.h"

#include <algorithm>

#include "lobe/solve/newton.h"

namespace lobe {

// One step as a minimum over u⁺: inertia is affine in u⁺, and f(u_α) is minus the gradient of W(u_α)/(1 −
// α_f).
class ImplicitStep::Problem : public NewtonProblem {
 public:
  Problem(ImplicitStep& owner, const StepLoads& loads, double dt, const DynamicState& from)
      : o_(owner), loads_(loads), dt_(dt), from_(from), inertia_at_start_(inertia(end(from.u))) {}

  DynamicState end(const Mat3X<double>& u) const;
  NewtonPoint at(const Mat3X<double>& u) const override;
  bool direction(const NewtonPoint& at, Mat3X<double>& direction) override;
  NewtonPoint start() const;

 private:
  Mat3X<double> alpha(const Mat3X<double>& u) const { return (1 - o_.alpha_f_) * u + o_.alpha_f_ * from_.u; }
  Mat3X<double> inertia(const DynamicState& end) const;

  ImplicitStep& o_;
  const StepLoads& loads_;
  double dt_;
  const DynamicState& from_;
  Mat3X<double> inertia_at_start_;  // for u⁺ = u
};

DynamicState ImplicitStep::Problem::end(const Mat3X<double>& u) const {
  const double beta = o_.beta(), gamma = o_.gamma();
  DynamicState end;
  end.u = u;
  end.a = ((u - from_.u) / dt_ - from_.v) / (beta * dt_) - (0.5 / beta - 1) * from_.a;
  end.v = from_.v + dt_ * ((1 - gamma) * from_.a + gamma * end.a);
  return end;
}

Mat3X<double> ImplicitStep::Problem::inertia(const DynamicState& end) const {
  Mat3X<double> f = (1 - o_.alpha_m_) * end.a + o_.alpha_m_ * from_.a;
  f += loads_.damping * ((1 - o_.alpha_f_) * end.v + o_.alpha_f_ * from_.v);
  for (Eigen::Index v = 0; v < f.cols(); ++v) f.col(v) *= loads_.mass[std::size_t(v)];
  o_.unknowns_->clear_prescribed(f);
  return f;
}

NewtonPoint ImplicitStep::Problem::at(const Mat3X<double>& u) const {
  const Mat3X<double> inertial = inertia(end(u)), moved = u - from_.u;
  const EnergyAndForces e = energy_and_forces(*o_.elements_, o_.tangent_->averages(), alpha(u));
  NewtonPoint point;
  point.u = u;
  point.potential = e.energy / (1 - o_.alpha_f_) - loads_.external.cwiseProduct(moved).sum() +
                    moved.cwiseProduct(inertial + inertia_at_start_).sum() / 2;
  point.residual = loads_.external + e.forces - inertial;
  o_.unknowns_->clear_prescribed(point.residual);
  point.scale = std::max({loads_.external.norm(), e.forces.norm(), inertial.norm()});
  point.smallest_volume_ratio = e.smallest_volume_ratio;
  point.smallest_tet = e.smallest_tet;
  return point;
}

bool ImplicitStep::Problem::direction(const NewtonPoint& at, Mat3X<double>& direction) {
  o_.tangent_->update(alpha(at.u));
  const double inertial =
      ((1 - o_.alpha_m_) / dt_ + loads_.damping * (1 - o_.alpha_f_) * o_.gamma()) / (o_.beta() * dt_);
  o_.tangent_->scale_and_add_mass(1 - o_.alpha_f_, inertial, loads_.mass);
  bool damped = false;
  if (!o_.tangent_->factorise(*o_.factor_, damped)) return false;
  direction = o_.unknowns_->scatter(o_.tangent_->solve(*o_.factor_, o_.unknowns_->gather(at.residual)));
  return true;
}

// Starts from the motion at constant velocity, or, if that inverts a tetrahedron, from the present positions.
NewtonPoint ImplicitStep::Problem::start() const {
  const auto with_given = [&](Mat3X<double> u) {
    for (Eigen::Index i = 0; i < u.size(); ++i)
      if (o_.unknowns_->number.data()[i] < 0) u.data()[i] = loads_.prescribed.data()[i];
    return u;
  };
  NewtonPoint straight_on = at(with_given(from_.u + dt_ * from_.v)), here = at(with_given(from_.u));
  const bool better = straight_on.smallest_volume_ratio > std::min(0.0, here.smallest_volume_ratio) &&
                      straight_on.potential < here.potential;
  return better ? straight_on : here;
}

void ImplicitStep::rebuild(const Elements& elements, const HeldVertices& held) {
  elements_ = &elements;
  tangent_.reset();
  unknowns_.emplace(free_components(elements, held));
  tangent_.emplace(elements, *unknowns_);
  factor_ = tangent_->make_factor(make_factor_);
}

bool ImplicitStep::step(const StepLoads& loads, double dt, DynamicState& motion) {
  constexpr double tolerance = 1e-10;
  constexpr int most_iterations = 30;
  Problem problem(*this, loads, dt, motion);
  NewtonPoint point = problem.start();
  if (!minimise(problem, point, tolerance, most_iterations).converged) return false;
  DynamicState end = problem.end(point.u);
  for (Eigen::Index i = 0; i < end.u.size(); ++i) {
    if (unknowns_->number.data()[i] >= 0) continue;
    end.v.data()[i] = (end.u.data()[i] - motion.u.data()[i]) / dt;
    end.a.data()[i] = 0;
  }
  motion = std::move(end);
  return true;
}

}  // namespace lobe
