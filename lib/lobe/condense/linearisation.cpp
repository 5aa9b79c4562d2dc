#include "lobe/condense/linearisation.h"

#include "lobe/region/energy_density.h"

namespace lobe {
namespace {

template <class Vertices>
Mat3X<double> at(const Mat3X<double>& about, const Vertices& vertices) {
  if (about.size() == 0) return Mat3X<double>::Zero(3, Eigen::Index(vertices.size()));
  return about(Eigen::all, vertices);
}

Mat3<double> gradient_of(const Shape& s, const Mat34<double>& u) {
  return displacement_gradient<double>(u, s.gradients.rightCols<3>());
}

// The same of a domain, u of its own vertices.
Mat3<double> gradient_of(const SmoothedEdge& domain, const Mat3X<double>& u) {
  Mat3<double> H = Mat3<double>::Zero();
  for (std::size_t j = 1; j < domain.vertices.size(); ++j)
    H += (u.col(Eigen::Index(j)) - u.col(0)) * domain.gradients[j].transpose();
  return H;
}

template <int size, class Columns>
double energy_of(double energy_at_start, const Linearisation::Forces<size>& linear, const Columns& start,
                 const Columns& u) {
  const Eigen::Matrix<double, size, 1> from = start.reshaped(), to = u.reshaped(), d = to - from,
                                       f = linear.constant - linear.K * from;
  return energy_at_start - f.dot(d) + 0.5 * d.dot(linear.K * d);
}

template <int size, class Columns>
Columns forces_of(const Linearisation::Forces<size>& linear, const Columns& u) {
  return (linear.constant - linear.K * u.reshaped()).reshaped(3, u.cols());
}

}  // namespace

Linearisation::Forces<12> Linearisation::forces(const Elements& elements, Index tet,
                                                const Eigen::Vector4i& corners) const {
  const Mat34<double> start = at(about, corners);
  Forces<12> linear{unsmoothed_stiffness(elements, tet, start, model()),
                    Eigen::Matrix<double, 12, 1>::Zero()};
  if (is_at_rest()) return linear;
  const Shape s = elements.shape_of(tet);
  const Mat3<double> P = unsmoothed_stress(elements, tet, gradient_of(s, start), model());
  linear.constant = corner_forces<double>(s.volume * P, s.gradients.rightCols<3>()).reshaped() +
                    linear.K * start.reshaped();
  return linear;
}

Linearisation::Forces<Eigen::Dynamic> Linearisation::forces(const Elements& elements,
                                                            const SmoothedEdge& domain) const {
  const Mat3X<double> start = at(about, domain.vertices);
  const Mat3<double> H = gradient_of(domain, start);
  Forces<Eigen::Dynamic> linear{domain_stiffness(elements, domain, H, model()),
                                Eigen::VectorXd::Zero(start.size())};
  if (!is_at_rest())
    linear.constant =
        vertex_forces(domain, stress(elements, domain, H, model())).reshaped() + linear.K * start.reshaped();
  return linear;
}

Mat34<double> Linearisation::forces_at(const Elements& elements, Index tet, const Mat34<double>& u) const {
  return forces_of(forces(elements, tet, elements.topology.corners(tet)), u);
}

Mat3X<double> Linearisation::forces_at(const Elements& elements, const SmoothedEdge& domain,
                                       const Mat3X<double>& u) const {
  if (!is_at_rest()) return forces_of(forces(elements, domain), u);
  return vertex_forces(domain, stress(elements, domain, gradient_of(domain, u), model()));
}

double Linearisation::energy(const Elements& elements, Index tet, const Mat34<double>& u) const {
  const Shape s = elements.shape_of(tet);
  const auto energy_at = [&](const Mat34<double>& corners) {
    return s.volume * unsmoothed_energy_density(elements, tet, gradient_of(s, corners), model());
  };
  if (is_at_rest()) return energy_at(u);
  const Eigen::Vector4i corners = elements.topology.corners(tet);
  const Mat34<double> start = at(about, corners);
  return energy_of(energy_at(start), forces(elements, tet, corners), start, u);
}

double Linearisation::energy(const Elements& elements, const SmoothedEdge& domain,
                             const Mat3X<double>& u) const {
  const auto energy_at = [&](const Mat3X<double>& of_vertices) {
    return domain.volume * energy_density(elements, domain, gradient_of(domain, of_vertices), model());
  };
  if (is_at_rest()) return energy_at(u);
  const Mat3X<double> start = at(about, domain.vertices);
  return energy_of(energy_at(start), forces(elements, domain), start, u);
}

}  // namespace lobe
