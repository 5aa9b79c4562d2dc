#include "lobe/linearity/defect.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <map>

#include "lobe/fem/hooke.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"

namespace lobe {
namespace {

using Column = Eigen::Matrix<double, 9, 1>;

Column column(const Mat3<double>& A) { return A.reshaped(); }
Mat3<double> matrix(const Column& a) { return a.reshaped(3, 3); }

}  // namespace

Mat3<double> twin(const Mat3<double>& H) {
  constexpr double least_stretch = 0.2;
  const Mat3<double> I = Mat3<double>::Identity(), strain = (H + H.transpose()) / 2;
  Eigen::SelfAdjointEigenSolver<Mat3<double>> principal;
  principal.computeDirect(strain);
  const Vec3d stretches = (1 + 2 * principal.eigenvalues().array()).max(least_stretch * least_stretch).sqrt();
  const Mat3<double> stretch =
      principal.eigenvectors() * stretches.asDiagonal() * principal.eigenvectors().transpose();
  const Vec3d turn(H(2, 1) - H(1, 2), H(0, 2) - H(2, 0), H(1, 0) - H(0, 1));  // twice the rotation vector
  const double angle = turn.norm() / 2;
  if (angle == 0) return stretch - I;
  return Eigen::AngleAxisd(angle, turn / (2 * angle)).toRotationMatrix() * stretch - I;
}

Mat3<double> stress_defect(const Mat3<double>& H, double lambda, double mu, double kappa) {
  return svk_stress<double>(H, lambda, mu) + volume_stress<double>(H, kappa) -
         hooke_stress<double>(H, lambda, mu);
}

Defects exact_defects(const Elements& elements, const Zones& zones, const Mat3X<double>& u) {
  Defects defects = Defects::Zero(9, zones.count());
  for (Index t = 0; t < static_cast<Index>(zones.of.size()); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Shape s = elements.shape_of(t);
    const Elastic& e = elements.elastic_of(t);
    const Mat34<double> corners = u(Eigen::all, elements.topology.corners(t));
    const Mat3<double> H = displacement_gradient<double>(corners, s.gradients.rightCols<3>());
    defects.col(zones.of[t]) += s.volume * column(stress_defect(H, e.lambda, e.mu, elements.volume_penalty));
  }
  return defects;
}

MeanDefects::MeanDefects(const Elements& elements, const Zones& zones)
    : weights_(std::size_t(zones.count())),
      mean_(std::size_t(zones.count())),
      kappa_(elements.volume_penalty) {
  for (Index z = 0; z < zones.count(); ++z) find(elements, zones, z);
}

void MeanDefects::find(const Elements& elements, const Zones& zones, Index zone) {
  std::map<Index, Vec3d> weights;
  Mean mean;
  for (Index t : zones.tets[std::size_t(zone)]) {
    if (!elements.topology.alive(t)) continue;
    const Shape s = elements.shape_of(t);
    const Elastic& e = elements.elastic_of(t);
    mean.volume += s.volume;
    mean.lambda += s.volume * e.lambda;
    mean.mu += s.volume * e.mu;
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
  mean_[std::size_t(zone)] = {mean.volume, mean.lambda / mean.volume, mean.mu / mean.volume};
}

Column MeanDefects::gradient(Index zone, const Mat3X<double>& u) const {
  Mat3<double> H = Mat3<double>::Zero();
  for (const Weight& w : weights_[std::size_t(zone)]) H += u.col(w.vertex) * w.gradient.transpose();
  return column(H);
}

Column MeanDefects::at(Index zone, const Column& gradient, bool is_linear) const {
  const Mean& mean = mean_[std::size_t(zone)];
  if (mean.volume == 0) return Column::Zero();
  const Mat3<double> H = is_linear ? twin(matrix(gradient)) : matrix(gradient);
  return mean.volume * column(stress_defect(H, mean.lambda, mean.mu, kappa_));
}

Column MeanDefects::beyond_tangent(Index zone, const Column& gradient, const Column& about,
                                   bool is_linear) const {
  const Mean& mean = mean_[std::size_t(zone)];
  if (mean.volume == 0) return Column::Zero();
  const auto stress = [&](const Column& g) {
    return column(svk_stress<double>(matrix(g), mean.lambda, mean.mu) +
                  volume_stress<double>(matrix(g), kappa_));
  };
  const Mat3<double> F0 = Mat3<double>::Identity() + matrix(about);
  const Mat3<double> since = matrix(gradient - about) * F0.inverse();
  const Column change = column((is_linear ? twin(since) : since) * F0);
  constexpr double step = 1e-4;  // of the change: the tangent as a central difference
  const Column tangent = (stress(about + step * change) - stress(about - step * change)) / (2 * step);
  return mean.volume * (stress(about + change) - stress(about) - tangent);
}

}  // namespace lobe
