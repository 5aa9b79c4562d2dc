#include "lobe/linearity/defect.h"

#include <Eigen/Geometry>
#include <map>

#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/numerics/symmetric_eigen.h"
#include "lobe/region/averages.h"
#include "lobe/region/energy_density.h"

namespace lobe {
namespace {

using Column = Eigen::Matrix<double, 9, 1>;

Column column(const Mat3<double>& A) { return A.reshaped(); }
Mat3<double> matrix(const Column& a) { return a.reshaped(3, 3); }

// D of each smoothing domain.
std::vector<Column> domain_defects(const Elements& elements, const Averages& averages,
                                   const Mat3X<double>& u) {
  const std::vector<Mat3<double>> gradients = domain_gradients(averages.edges, u);
  const std::vector<double> pressures = domain_pressures(averages.edges, averages.edge_pressures, gradients);
  std::vector<Column> defects(gradients.size(), Column::Zero());
  for (Index e = 0; e < averages.edges.count(); ++e) {
    const SmoothedEdge& edge = averages.edges[e];
    const auto i = std::size_t(e);
    if (edge.volume > 0)
      defects[i] = column(stress_defect(smoothed_law(elements, edge, pressures[i]),
                                        smoothed_linear_law(elements, edge), gradients[i]));
  }
  return defects;
}

}  // namespace

Mat3<double> nonlinear_gradient(const Mat3<double>& H) {
  constexpr double least_stretch = 0.2;
  const Mat3<double> I = Mat3<double>::Identity(), strain = (H + H.transpose()) / 2;
  const SymmetricEigen<Mat3<double>> principal = direct_symmetric_eigen(strain);
  const Vec3d stretches = (1 + 2 * principal.values.array()).max(least_stretch * least_stretch).sqrt();
  const Mat3<double> stretch = principal.vectors * stretches.asDiagonal() * principal.vectors.transpose();
  const Vec3d turn(H(2, 1) - H(1, 2), H(0, 2) - H(2, 0), H(1, 0) - H(0, 1));  // twice the rotation vector
  const double angle = turn.norm() / 2;
  if (angle == 0) return stretch - I;
  return Eigen::AngleAxisd(angle, turn / (2 * angle)).toRotationMatrix() * stretch - I;
}

Mat3<double> stress_defect(const Law<double>& law, const Law<double>& linear, const Mat3<double>& H) {
  return law_stress(law, H) - linear_stress(linear, H);
}

Defects exact_defects(const Elements& elements, const Zones& zones, const Mat3X<double>& u) {
  Elements nonlinear = elements;
  nonlinear.region_of.assign(elements.region_of.size(), RegionModel::nonlinear);
  const Averages averages(nonlinear);
  const std::vector<double> pressures = tet_pressures(nonlinear, averages.nodes, u);
  const std::vector<Column> of_domains = domain_defects(nonlinear, averages, u);
  Defects defects = Defects::Zero(9, zones.count());
  for (Index t = 0; t < static_cast<Index>(zones.of.size()); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Shape s = elements.shape_of(t);
    const Mat34<double> corners = u(Eigen::all, elements.topology.corners(t));
    const Mat3<double> H = displacement_gradient<double>(corners, s.gradients.rightCols<3>());
    const auto own = [&](RegionModel model) {
      return unsmoothed_stress(nonlinear, t, H, model, pressures[std::size_t(t)]);
    };
    const Mat3<double> D = own(RegionModel::nonlinear) - own(RegionModel::tensor_mass);
    defects.col(zones.of[t]) += s.volume * column(D);
    for (Index e : averages.edges.of(t))
      if (e >= 0) defects.col(zones.of[t]) += s.volume / 6 * of_domains[std::size_t(e)];
  }
  return defects;
}

MeanDefects::MeanDefects(const Elements& elements, const Zones& zones)
    : weights_(std::size_t(zones.count())),
      mean_(std::size_t(zones.count())),
      volume_penalty_(elements.volume_penalty),
      guard_below_(elements.guard_below) {
  for (Index z = 0; z < zones.count(); ++z) find(elements, zones, z);
}

void MeanDefects::find(const Elements& elements, const Zones& zones, Index zone) {
  const MeanMaterial& mean = mean_[std::size_t(zone)] =
      mean_material(elements, zones.tets[std::size_t(zone)]);
  std::map<Index, Vec3d> weights;
  for (Index t : zones.tets[std::size_t(zone)]) {
    if (!elements.topology.alive(t)) continue;
    const Shape s = elements.shape_of(t);
    for (int c = 0; c < 4; ++c) {
      const auto [at, is_new] = weights.try_emplace(elements.topology.tets()(c, t), Vec3d::Zero());
      at->second += s.volume * s.gradients.col(c);
    }
  }
  std::vector<Weight>& list = weights_[std::size_t(zone)];
  list.clear();
  const double size = std::cbrt(mean.volume);
  for (const auto& [vertex, gradient] : weights)  // those of vertices within the zone vanish
    if (gradient.norm() > 1e-9 * size * size) list.push_back({vertex, gradient / mean.volume});
}

Column MeanDefects::gradient(Index zone, const Mat3X<double>& u) const {
  Mat3<double> H = Mat3<double>::Zero();
  for (const Weight& w : weights_[std::size_t(zone)]) H += u.col(w.vertex) * w.gradient.transpose();
  return column(H);
}

// If the gradient is the same everywhere, the nodal pressures are those of its strain: χλ θ.
Law<double> MeanDefects::law(const MeanMaterial& mean, const Mat3<double>& H) const {
  Law<double> law = nonlinear_law(mean.material, volume_penalty_, guard_below_,
                                  mean.material.nodal_lambda() * pressure_strain(H, mean.material.law));
  law.direction = mean.direction;
  return law;
}

Column MeanDefects::at(Index zone, const Column& gradient, bool is_linear) const {
  const MeanMaterial& mean = mean_[std::size_t(zone)];
  if (mean.volume == 0) return Column::Zero();
  const Mat3<double> H = is_linear ? nonlinear_gradient(matrix(gradient)) : matrix(gradient);
  Law<double> linear = linear_law(mean.material);
  linear.direction = mean.direction;
  return mean.volume * column(stress_defect(law(mean, H), linear, H));
}

Column MeanDefects::beyond_tangent(Index zone, const Column& gradient, const Column& about,
                                   bool is_linear) const {
  const MeanMaterial& mean = mean_[std::size_t(zone)];
  if (mean.volume == 0) return Column::Zero();
  const auto stress_at = [&](const Column& g) {
    const Mat3<double> H = matrix(g);
    return column(law_stress(law(mean, H), H));
  };
  const Mat3<double> F0 = Mat3<double>::Identity() + matrix(about);
  const Mat3<double> since = matrix(gradient - about) * F0.inverse();
  const Column change = column((is_linear ? nonlinear_gradient(since) : since) * F0);
  constexpr double step = 1e-4;  // of the change: the tangent as a central difference
  const Column tangent = (stress_at(about + step * change) - stress_at(about - step * change)) / (2 * step);
  return mean.volume * (stress_at(about + change) - stress_at(about) - tangent);
}

}  // namespace lobe
