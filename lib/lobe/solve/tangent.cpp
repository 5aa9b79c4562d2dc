#include "lobe/solve/tangent.h"

#include <Eigen/Geometry>
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

Eigen::SparseMatrix<double> tangent(const Elements& elements, const Mat3X<double>& u,
                                    const std::vector<Index>& unknown, Index unknowns) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(std::size_t(elements.topology.alive_count()) * 78);
  for (Index t = 0; t < elements.topology.tet_count(); ++t) {
    if (!elements.topology.alive(t)) continue;
    const TetStiffness K = tet_stiffness(elements, t, corners_of(elements, t, u));
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j) {
        const Index row = unknown[elements.topology.tets()(i / 3, t)];
        const Index column = unknown[elements.topology.tets()(j / 3, t)];
        if (row >= 0 && column >= 0 && row + i % 3 >= column + j % 3)
          entries.emplace_back(row + i % 3, column + j % 3, K(i, j));
      }
  }
  Eigen::SparseMatrix<double> A(unknowns, unknowns);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

}  // namespace lobe
