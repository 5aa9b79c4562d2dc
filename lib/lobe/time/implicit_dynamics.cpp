#include "lobe/time/implicit_dynamics.h"

namespace lobe {

ImplicitDynamics::ImplicitDynamics(double spectral_radius) : step_(spectral_radius, make_ldlt) {}

Mat3X<double> ImplicitDynamics::acceleration(const Model& model) const {
  return is_current(model.revisions) ? acceleration_ : Mat3X<double>();
}

void ImplicitDynamics::set_acceleration(const Model& model, const Mat3X<double>& acceleration) {
  acceleration_ = acceleration;
  is_new_ = acceleration.size() == 0;
  has_tangent_ = false;
  at_ = model.revisions;
}

// The accelerations are computed from the forces after every edit.
bool ImplicitDynamics::step(Dynamics<double>& body, double dt, const PrescribedMotion& prescribed) {
  const Model& model = body.model;
  Motion<double>& motion = body.motion;
  const bool is_stale = !is_current(model.revisions);
  if (is_stale || !has_tangent_ || !step_.is_built_on(model.elements))
    step_.rebuild(model.elements, model.held);
  has_tangent_ = true;
  if (is_stale) {
    acceleration_ = -body.damping * motion.v.view();
    body.find_forces();
    for (Index v = 0; v < motion.forces.count(); ++v)
      acceleration_.col(v) += body.inertia.inverse_mass(v) * motion.forces.col(v);
    is_new_ = false;
    at_ = model.revisions;
  }
  StepLoads loads{body.inertia.mass(), body.loads.at(motion.time + step_.load_time() * dt), motion.u.view(),
                  body.damping};
  for (const auto& term : body.terms)
    term->add_forces(body.here(), loads.external);  // that do not depend on u
  for (const HeldVertices::Held& item : model.held.all()) {
    const Vec3d u = prescribed(item, motion.time + dt);
    for (int i = 0; i < 3; ++i)
      if (item.axes[i]) loads.prescribed(i, item.vertex) = u[i];
  }
  DynamicState next{motion.u.view(), motion.v.view(), acceleration_};
  if (!step_.step(loads, dt, next)) return false;
  motion.speeds.fastest = (next.u - motion.u.view()).colwise().norm().maxCoeff() / dt;
  motion.u.view() = next.u;
  motion.v.view() = next.v;
  acceleration_ = next.a;
  motion.time += dt;
  body.state_has_moved();
  return true;
}

}  // namespace lobe
