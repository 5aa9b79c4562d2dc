#include "lobe/linearity/influence.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "lobe/error.h"
#include "lobe/numerics/supernodal_factor.h"
#include "lobe/solve/floating.h"
#include "lobe/solve/tangent.h"

namespace lobe {
namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 6>;

constexpr double weak_spring =
    1e-9;  // of the mean stiffness of a vertex: keeps pieces that float where they are

// Computes averages over zones of fields of 3 × #vertices.
class Means {
 public:
  // Pieces that these unknowns leave free to move do not count.
  Means(const Elements& elements, const Zones& zones, const Unknowns& unknowns)
      : elements_(elements), zones_(zones), counts_(zones.of.size(), 0) {
    const auto is_prescribed = [&](Index v, int axis) { return unknowns.number(axis, v) < 0; };
    for (const std::vector<Index>& piece : elements.topology.pieces())
      if (is_held(elements, piece, is_prescribed))
        for (Index t : piece) counts_[std::size_t(t)] = 1;
  }

  // The force whose work with a displacement is its mean component in a zone.
  Mat3X<double> mean(Index zone, int axis) const {
    Mat3X<double> weights = Mat3X<double>::Zero(3, elements_.topology.vertex_count());
    for (Index t : zones_.tets[std::size_t(zone)])
      if (counts_[std::size_t(t)])
        for (Index v : elements_.topology.corners(t))
          weights(axis, v) += elements_.volume(t) / (4 * zones_.volume[std::size_t(zone)]);
    return weights;
  }

  Eigen::VectorXd displacements(const Mat3X<double>& u) const {
    Eigen::VectorXd means = Eigen::VectorXd::Zero(3 * zones_.count());
    for_tets([&](Index t, Index zone, const Shape& s) {
      const Mat34<double> corners = u(Eigen::all, elements_.topology.corners(t));
      means.segment<3>(3 * zone) += s.volume / zones_.volume[std::size_t(zone)] * corners.rowwise().mean();
    });
    return means;
  }

  Eigen::VectorXd gradients(const Mat3X<double>& u) const {
    Eigen::VectorXd means = Eigen::VectorXd::Zero(9 * zones_.count());
    for_tets([&](Index t, Index zone, const Shape& s) {
      const Mat34<double> corners = u(Eigen::all, elements_.topology.corners(t));
      const Mat3<double> H = displacement_gradient<double>(corners, s.gradients.rightCols<3>());
      means.segment<9>(9 * zone) += s.volume / zones_.volume[std::size_t(zone)] * H.reshaped();
    });
    return means;
  }

 private:
  template <class Visit>
  void for_tets(const Visit& visit) const {
    for (Index t = 0; t < static_cast<Index>(zones_.of.size()); ++t)
      if (counts_[std::size_t(t)]) visit(t, zones_.of[std::size_t(t)], elements_.shape_of(t));
  }
  const Elements& elements_;
  const Zones& zones_;
  std::vector<char> counts_;  // per tetrahedron
};

// Forces on the vertices of a grasp along its six rigid motions, of about the same size: 3 × #vertices by 6.
Columns rigid_forces(const Elements& elements, const Unknowns& unknowns, const std::vector<Index>& vertices) {
  Vec3d center = Vec3d::Zero();
  for (Index v : vertices) center += elements.points.col(v) / double(vertices.size());
  double size = 0;
  for (Index v : vertices) size = std::max(size, (elements.points.col(v) - center).norm());
  Columns forces = Columns::Zero(3 * elements.topology.vertex_count(), 6);
  for (Index v : vertices) {
    const Vec3d arm = (elements.points.col(v) - center) / (size > 0 ? size : 1);
    for (int axis = 0; axis < 3; ++axis) {
      forces(3 * v + axis, axis) = unknowns.number(axis, v) >= 0;
      forces.block<3, 1>(3 * v, 3 + axis) = Vec3d::Unit(axis).cross(arm);
    }
    for (int axis = 0; axis < 3; ++axis)
      if (unknowns.number(axis, v) < 0) forces.row(3 * v + axis).setZero();
  }
  return forces;
}

}  // namespace

Influence::Influence(const Elements& elements, const Zones& zones, const HeldVertices& held,
                     const std::vector<std::vector<Index>>& grasps) {
  const Unknowns unknowns = free_components(elements, held);
  Tangent K(elements, unknowns);
  const Index vertices = elements.topology.vertex_count();
  K.update(Mat3X<double>::Zero(3, vertices));
  std::vector<double> mass;
  for (Index v = 0; v < vertices; ++v) mass.push_back(lumped_mass(elements, v));
  const double total = std::accumulate(mass.begin(), mass.end(), 0.0);
  K.scale_and_add_mass(1, weak_spring * K.matrix().diagonal().head(unknowns.count).sum() / (3 * total), mass);
  const std::unique_ptr<SparseFactor> factor = K.make_factor(make_supernodal);
  bool damped = false;
  if (!K.factorise(*factor, damped))
    throw InputError("linear regions", "the stiffness of the body at rest is singular");
  const auto solve = [&](const Mat3X<double>& f) {
    return unknowns.scatter(K.solve(*factor, unknowns.gather(f)));
  };
  const Means means(elements, zones, unknowns);
  free_.resize(3 * zones.count(), 9 * zones.count());
  constexpr Index at_once = 96;  // columns
  for (Index begin = 0; begin < 3 * zones.count(); begin += at_once) {
    const Index end = std::min(3 * zones.count(), begin + at_once);
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(K.matrix().rows(), end - begin);
    for (Index row = begin; row < end; ++row)
      forces.col(row - begin).head(unknowns.count) = unknowns.gather(means.mean(row / 3, row % 3));
    const Eigen::MatrixXd fields = factor->solve_all(forces);
    for (Index row = begin; row < end; ++row) {
      const Eigen::VectorXd field = fields.col(row - begin).head(unknowns.count);
      free_.row(row) = means.gradients(unknowns.scatter(field)).cast<float>();
    }
  }
  for (const std::vector<Index>& vertices_held : grasps) {
    Grasp& grasp = grasps_.emplace_back();
    grasp.forces = rigid_forces(elements, unknowns, vertices_held);
    grasp.fields.resize(3 * vertices, 6);
    grasp.means.resize(3 * zones.count(), 6);
    grasp.gradients.resize(9 * zones.count(), 6);
    for (int i = 0; i < 6; ++i) {
      const Mat3X<double> field = solve(grasp.forces.col(i).reshaped(3, vertices));
      grasp.fields.col(i) = field.reshaped();
      grasp.means.col(i) = means.displacements(field);
      grasp.gradients.col(i) = means.gradients(field);
    }
  }
  M_ = free_;
}

// The forces that hold the grasps in place follow from the work that they do: R (Rᵀ K⁻¹ R)⁻¹ Rᵀ. A grasp of
// one vertex cannot turn, so that the small matrix may be singular.
void Influence::hold(const std::vector<Index>& grasps) {
  if (grasps == holding_) return;
  holding_ = grasps;
  M_ = free_;
  if (grasps.empty()) return;
  const auto size = Eigen::Index(6 * grasps.size());
  Eigen::MatrixXd work(size, size), means(free_.rows(), size), gradients(free_.cols(), size);
  for (Eigen::Index i = 0; i < Eigen::Index(grasps.size()); ++i) {
    const Grasp& grasp = grasps_[std::size_t(grasps[std::size_t(i)])];
    means.middleCols<6>(6 * i) = grasp.means;
    gradients.middleCols<6>(6 * i) = grasp.gradients;
    for (Eigen::Index j = 0; j < Eigen::Index(grasps.size()); ++j)
      work.block<6, 6>(6 * i, 6 * j) =
          grasp.forces.transpose() * grasps_[std::size_t(grasps[std::size_t(j)])].fields;
  }
  Eigen::FullPivLU<Eigen::MatrixXd> lu(work);
  lu.setThreshold(1e-9);
  M_ -= (means * Eigen::MatrixXd(lu.solve(gradients.transpose()))).cast<float>();
}

}  // namespace lobe
