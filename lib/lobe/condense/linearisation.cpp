#include "lobe/condense/linearisation.h"

#include "lobe/region/energy_density.h"

namespace lobe {
namespace {

Mat34<double> at(const Mat3X<double>& about, const Eigen::Vector4i& corners) {
  if (about.size() == 0) return Mat34<double>::Zero();
  return about(Eigen::all, corners);
}

}  // namespace

Linearisation::Forces Linearisation::forces(const Elements& elements, Index tet,
                                            const Eigen::Vector4i& corners) const {
  const Mat34<double> start = at(about, corners);
  Forces linear{tet_stiffness(elements, tet, start, model()), Eigen::Matrix<double, 12, 1>::Zero()};
  if (is_at_rest()) return linear;
  const Shape s = elements.shape_of(tet);
  const Mat3<double> alpha = s.gradients.rightCols<3>();
  const Mat3<double> P = stress(elements, tet, displacement_gradient<double>(start, alpha), model());
  linear.constant = corner_forces<double>(s.volume * P, alpha).reshaped() + linear.K * start.reshaped();
  return linear;
}

double Linearisation::energy(const Elements& elements, Index tet, const Mat34<double>& u) const {
  const Shape s = elements.shape_of(tet);
  const auto gradient = [&](const Mat34<double>& corners) {
    return displacement_gradient<double>(corners, s.gradients.rightCols<3>());
  };
  if (is_at_rest()) return s.volume * energy_density(elements, tet, gradient(u), model());
  const Eigen::Vector4i corners = elements.topology.corners(tet);
  const Mat34<double> start = at(about, corners);
  const Forces linear = forces(elements, tet, corners);
  const Eigen::Matrix<double, 12, 1> from = start.reshaped(), to = u.reshaped(), d = to - from,
                                     f = linear.constant - linear.K * from;
  return s.volume * energy_density(elements, tet, gradient(start), model()) - f.dot(d) +
         0.5 * d.dot(linear.K * d);
}

}  // namespace lobe
