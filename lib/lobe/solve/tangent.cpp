#include "lobe/solve/tangent.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lobe/fem/hooke.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"

namespace lobe {
namespace {

Mat34<double> corners_of(const Elements& elements, Index tet, const Mat3X<double>& u) {
  Mat34<double> corners;
  for (int c = 0; c < 4; ++c) corners.col(c) = u.col(elements.topology.tets()(c, tet));
  return corners;
}

Mat3<double> cross_matrix(const Vec3d& a) {
  Mat3<double> A;
  A << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return A;
}

}  // namespace

EnergyAndForces energy_and_forces(const Elements& elements, const Mat3X<double>& u) {
  EnergyAndForces result;
  result.forces.setZero(3, u.cols());
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const Shape s = elements.shape_of(t);
    const auto& [lambda, mu, density, nodal_pressure] = elements.elastic_of(t);
    const Mat3<double> alpha = s.gradients.rightCols<3>();
    const Mat3<double> H = displacement_gradient(corners_of(elements, t, u), alpha);
    Mat3<double> P;
    if (elements.region_of[t] == RegionModel::nonlinear) {
      const double ratio = 1 + volume_change(H);
      if (ratio < result.smallest_volume_ratio) {
        result.smallest_volume_ratio = ratio;
        result.smallest_tet = t;
      }
      result.energy +=
          s.volume * (svk_energy_density(H, lambda, mu) + volume_energy_density(H, elements.volume_penalty));
      P = svk_stress(H, lambda, mu) + volume_stress(H, elements.volume_penalty);
    } else {
      result.energy += s.volume * hooke_energy_density(H, lambda, mu);
      P = hooke_stress(H, lambda, mu);
    }
    const Mat34<double> f = corner_forces<double>(s.volume * P, alpha);
    for (int c = 0; c < 4; ++c) result.forces.col(elements.topology.tets()(c, t)) += f.col(c);
  }
  return result;
}

TetStiffness tet_stiffness(const Elements& elements, Index tet, const Mat34<double>& u) {
  const Shape s = elements.shape_of(tet);
  const Mat34<double>& alpha = s.gradients;
  const auto& [lambda, mu, density, nodal_pressure] = elements.elastic_of(tet);
  const Mat3<double> H = displacement_gradient<double>(u, alpha.rightCols<3>());
  const bool nonlinear = elements.region_of[tet] == RegionModel::nonlinear;
  const Mat3<double> F = Mat3<double>::Identity() + H, S = svk_second_stress(H, lambda, mu);
  const double kappa = elements.volume_penalty, v = volume_change(H);
  const Mat34<double> g = cofactor(F) * alpha;
  TetStiffness K;
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k) {
      Mat3<double> block = hooke_block<double>(alpha.col(j), alpha.col(k), lambda, mu);
      if (nonlinear) {
        block = F * block * F.transpose();
        block.diagonal().array() += alpha.col(j).dot(S * alpha.col(k));
        const Vec3d turned = F * Vec3d(alpha.col(j)).cross(Vec3d(alpha.col(k)));
        block += 2 * kappa * std::abs(v) * g.col(j) * g.col(k).transpose() -
                 kappa * v * std::abs(v) * cross_matrix(turned);
      }
      K.block<3, 3>(3 * j, 3 * k) = s.volume * block;
    }
  return K;
}

namespace {

// Entry (i, j), i >= j, of a tetrahedron's matrix stands at row, column of the lower triangle; row −1 if it is given.
struct Place {
  Index row = -1, column = -1;
};

Place place_of(const Unknowns& unknowns, const Eigen::Vector4i& corners, int i, int j) {
  const Index a = unknowns.number(i % 3, corners[i / 3]), b = unknowns.number(j % 3, corners[j / 3]);
  if (a < 0 || b < 0) return {};
  return {std::max(a, b), std::min(a, b)};
}

template <class Visit>  // visit(tetrahedron) for all that are alive
void for_alive(const Elements& elements, Visit&& visit) {
  for (Index t = 0; t < elements.topology.tet_count(); ++t)
    if (elements.topology.alive(t)) visit(t);
}

}  // namespace

Tangent::Tangent(const Elements& elements, const Unknowns& unknowns)
    : elements_(elements), unknowns_(unknowns), matrix_(unknowns.count, unknowns.count) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto for_places = [&](auto&& visit) {
    for_alive(elements, [&](Index t) {
      for (int j = 0; j < 12; ++j)
        for (int i = j; i < 12; ++i) visit(place_of(unknowns, elements.topology.corners(t), i, j));
    });
  };
  entries.reserve(std::size_t(elements.topology.alive_count()) * 78);
  for_places([&](Place p) {
    if (p.row >= 0) entries.emplace_back(p.row, p.column, 0.0);
  });
  matrix_.setFromTriplets(entries.begin(), entries.end());
  place_.reserve(std::size_t(elements.topology.alive_count()) * 78);
  for_places([&](Place p) {
    if (p.row < 0) return place_.push_back(-1);
    const int* rows = matrix_.innerIndexPtr();
    const int *begin = rows + matrix_.outerIndexPtr()[p.column],
              *end = rows + matrix_.outerIndexPtr()[p.column + 1];
    place_.push_back(static_cast<Index>(std::lower_bound(begin, end, p.row) - rows));
  });
}

void Tangent::update(const Mat3X<double>& u) {
  matrix_.coeffs().setZero();
  double* values = matrix_.valuePtr();
  auto place = place_.begin();
  for_alive(elements_, [&](Index t) {
    const TetStiffness K = tet_stiffness(elements_, t, corners_of(elements_, t, u));
    for (int j = 0; j < 12; ++j)
      for (int i = j; i < 12; ++i, ++place)
        if (*place >= 0) values[*place] += K(i, j);
  });
}

Eigen::VectorXd Tangent::times(const Mat3X<double>& u, const Mat3X<double>& w) const {
  Mat3X<double> f = Mat3X<double>::Zero(3, u.cols());
  for_alive(elements_, [&](Index t) {
    const Mat34<double> by = corners_of(elements_, t, w);
    if (by.isZero(0)) return;
    const Eigen::Matrix<double, 12, 1> force =
        tet_stiffness(elements_, t, corners_of(elements_, t, u)) * by.reshaped();
    for (int c = 0; c < 4; ++c) f.col(elements_.topology.tets()(c, t)) += force.segment<3>(3 * c);
  });
  return unknowns_.gather(f);
}

}  // namespace lobe
