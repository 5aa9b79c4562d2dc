#include "lobe/solve/static_equations.h"

#include "lobe/body/hold_springs.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {
namespace {

Mat3X<double> prescribed_displacements(const HeldVertices& held, Index vertices) {
  Mat3X<double> u = Mat3X<double>::Zero(3, vertices);
  for (const HeldVertices::Held& item : held.all())
    for (int axis = 0; axis < 3; ++axis)
      if (item.axes[axis]) u(axis, item.vertex) = item.goal[axis];
  return u;
}

// Adds the springs of partly held vertices. Several on one component act as one, from the mean of their
// places.
void add_hold_springs(const HeldVertices& held, const Elements& elements, StaticEquations& equations) {
  if (held.partly().empty()) return;
  const Index vertices = elements.topology.vertex_count();
  equations.stiffness.setZero(3, vertices);
  equations.spring_targets.setZero(3, vertices);
  for (const HeldVertices::Held& item : held.partly()) {
    const double k = hold_stiffness(elements, item);
    for (int axis = 0; axis < 3; ++axis) {
      if (!item.axes[axis] || equations.unknowns.number(axis, item.vertex) < 0) continue;
      equations.stiffness(axis, item.vertex) += k;
      equations.spring_targets(axis, item.vertex) += k * item.goal[axis];
    }
  }
  for (Eigen::Index i = 0; i < equations.stiffness.size(); ++i)
    if (const double k = equations.stiffness.data()[i]; k > 0) equations.spring_targets.data()[i] /= k;
}

}  // namespace

StaticEquations static_equations(const Setup& setup, const Elements& elements) {
  const HeldVertices held = held_by(setup);
  StaticEquations equations{free_components(elements, held),
                            prescribed_displacements(held, elements.topology.vertex_count()),
                            dead_loads(elements, setup.face_loads, setup.vertex_loads)};
  for (Index v = 0; v < equations.loads.cols(); ++v)
    equations.loads.col(v) += lumped_mass(elements, v) * setup.gravity;
  add_hold_springs(held, elements, equations);
  return equations;
}

}  // namespace lobe
