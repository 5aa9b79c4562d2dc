// What a lattice does not balance (theory, section 18).
#include <Eigen/LU>

#include "lobe/lattice/lattice_region.h"

namespace lobe {
namespace {

// The rotation R of F = R U, by Newton's iterations (N. J. Higham, Computing the polar decomposition, 1986).
// None where F is not invertible or turns inside out.
Mat3<double> rotation(const Mat3<double>& F) {
  constexpr int iterations = 6;
  constexpr double least = 0.05;  // of volume
  if (!(F.determinant() > least)) return Mat3<double>::Identity();
  Mat3<double> R = F;
  for (int i = 0; i < iterations; ++i) R = 0.5 * (R + R.inverse().transpose()).eval();
  return R;
}

// Of the tetrahedra around a vertex, in the mean.
template <class Real>
Mat3<double> rotation_around(const Elements& elements, Index v, const Mat3X<Real>& u) {
  Mat3<double> F = Mat3<double>::Zero();
  double volume = 0;
  for (Index t : elements.topology.around(v)) {
    const Shape shape = elements.shape_of(t);
    const Mat34<double> corners = u(Eigen::all, elements.topology.corners(t)).template cast<double>();
    F += shape.volume * (Mat3<double>::Identity() + corners * shape.gradients.transpose());
    volume += shape.volume;
  }
  return rotation(F / volume);
}

}  // namespace

template <class Real>
Mat3<double> LatticeRegion<Real>::rotation_of(Index part, const Mat3X<Real>& q) const {
  const CellGradients middle = cell_gradients(Vec3d::Constant(0.5), lattice_.frame.edge);
  Mat3<double> F = Mat3<double>::Identity();
  for (int n = 0; n < 8; ++n)
    F += q.col(lattice_.parts[std::size_t(part)].nodes[std::size_t(n)]).template cast<double>() *
         middle.row(n);
  return rotation(F);
}

template <class Real>
Mat3X<Real> LatticeRegion<Real>::fading(const StateColumns<Real>& state) const {
  Mat3X<Real> left;
  fading_.visit(state, [&](Index v, const Vec3<Real>& u) {
    if (left.size() == 0) left = Mat3X<Real>::Zero(3, state.u.count());
    const Index part = lattice_.part_of_vertex[std::size_t(v)];
    left.col(v) = rotation_of(part, state.nodes.u).transpose().template cast<Real>() * u;
  });
  return left;
}

// Displacements must not have been recovered yet.
template <class Real>
void LatticeRegion<Real>::note_lost(const Elements& elements, const Mat3X<Real>& faded_before,
                                    const Motion<Real>& motion) {
  const auto count = Eigen::Index(elements.topology.vertex_count()), known = lost_.cols();
  lost_.conservativeResize(3, count);
  lost_.rightCols(count - known).setZero();
  lost_.leftCols(faded_before.cols()) -= faded_before;
  for (Index v : embedding_.vertices) {
    const Index part = lattice_.part_of_vertex[std::size_t(v)];
    const CellWeights w = lattice_.weights(v, elements.points.col(v));
    Vec3d u = motion.u.col(v).template cast<double>();
    for (int n = 0; n < 8; ++n)
      u -=
          w[n] *
          motion.nodes.u.col(lattice_.parts[std::size_t(part)].nodes[std::size_t(n)]).template cast<double>();
    lost_.col(v) += (rotation_of(part, motion.nodes.u).transpose() * u).template cast<Real>();
  }
}

template <class Real>
Mat3X<double> LatticeRegion<Real>::residual(const Elements& elements, const Loads<Real>& loads,
                                            const std::vector<double>& own_mass,
                                            const std::vector<double>& mass, const Motion<Real>& motion,
                                            Parallel& parallel) {
  Mat3X<double> r = Mat3X<double>::Zero(3, motion.u.count());
  if (!any_embedded()) return r;
  Mat3X<Real> f = Mat3X<Real>::Zero(3, motion.u.padded().cols()), of_fading;
  if (fading_.any()) {
    Mat3X<Real> u = motion.u.padded();
    fading_.visit(motion, [&](Index v, const Vec3<Real>& left) { u.col(v) -= left; });
    all_.add_forces(u, f, parallel);
    of_fading = Mat3X<Real>::Zero(3, u.cols());
    full_.add_forces(motion.u.padded(), of_fading, parallel);
    of_fading = -of_fading;
    full_.add_forces(u, of_fading, parallel);
  } else {
    all_.add_forces(motion.u.padded(), f, parallel);
  }
  std::vector<Mat3<double>> turn(lattice_.parts.size(), Mat3<double>::Zero());  // Rᵀ of each part
  for (Index v : embedding_.vertices) {
    if (v >= static_cast<Index>(own_mass.size())) continue;
    const auto part = std::size_t(lattice_.part_of_vertex[std::size_t(v)]);
    const auto& nodes = lattice_.parts[part].nodes;
    const CellWeights w = lattice_.weights(v, elements.points.col(v));
    Vec3d acceleration = Vec3d::Zero();  // and what damping takes of it
    for (std::size_t n = 0; n < 8; ++n)
      acceleration += w[Eigen::Index(n)] / embedding_.mass[std::size_t(nodes[n])] *
                      motion.node_forces.col(nodes[n]).template cast<double>();
    const double own = own_mass[std::size_t(v)];
    if (turn[part].isZero(0)) turn[part] = rotation_of(static_cast<Index>(part), motion.nodes.u).transpose();
    const Vec3d load = loads.of_vertex(elements, v, own, motion.time);
    r.col(v) = turn[part] * (f.col(v).template cast<double>() + load - own * acceleration);
  }
  for (Index v : vertices_) {
    if (embeds(v)) continue;
    Vec3d own = Vec3d::Zero();
    if (const double added = zone_mass_.added(v); added > 0)
      own = added / mass[std::size_t(v)] * motion.forces.col(v).template cast<double>();
    if (of_fading.size() > 0) own += of_fading.col(v).template cast<double>();
    if (!own.isZero(0)) r.col(v) = rotation_around(elements, v, motion.u.padded()).transpose() * own;
  }
  return r;
}

}  // namespace lobe
