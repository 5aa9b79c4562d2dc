#include "benchmarks/reference_kernel.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <map>
#include <utility>

namespace lobe::bench {
namespace {

// The corners are gathered first: Σ u_j⊗α_j summed in memory, term by term, takes twice as long.
Mat34<double> at_corners(const ReferenceTet& tet, const Mat3X<double>& u) {
  Mat34<double> corners;
  for (int j = 0; j < 4; ++j) corners.col(j) = u.col(tet.corners[j]);
  return corners;
}

Mat3<double> deformation(const ReferenceTet& tet, const Mat3X<double>& u) {
  return Mat3<double>::Identity() + at_corners(tet, u) * tet.alpha.transpose();
}

Mat3<double> edges(const Mat3X<double>& x, const Eigen::Vector4i& v) {
  Mat3<double> D;
  D << x.col(v[1]) - x.col(v[0]), x.col(v[2]) - x.col(v[0]), x.col(v[3]) - x.col(v[0]);
  return D;
}

}  // namespace

std::vector<ReferenceTet> reference_tets(const Setup& setup) {
  std::vector<ReferenceTet> tets;
  for (Index t = 0; t < setup.mesh.tet_count(); ++t) {
    const Elastic& elastic = setup.materials[setup.material_of[t]];
    ReferenceTet tet;
    tet.corners = setup.mesh.tets.col(t);
    const Mat3<double> D = edges(setup.mesh.points, tet.corners);
    tet.alpha.rightCols<3>() = D.inverse().transpose();
    tet.alpha.col(0) = -tet.alpha.rightCols<3>().rowwise().sum();
    tet.V = D.determinant() / 6;
    tet.lambda = elastic.lambda;
    tet.mu = elastic.mu;
    tet.corner_mass = elastic.density * tet.V / 4;
    tets.push_back(tet);
  }
  return tets;
}

void add_reference_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u, Mat3X<double>& f) {
  const Mat3<double> I = Mat3<double>::Identity();
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> F = deformation(tet, u);
    const Mat3<double> E = 0.5 * (F.transpose() * F - I);
    const Mat3<double> S = tet.lambda * E.trace() * I + 2 * tet.mu * E;
    const Mat34<double> g = tet.V * (F * S) * tet.alpha;
    for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= g.col(j);
  }
}

void add_reference_linear_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                 Mat3X<double>& f) {
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> H = at_corners(tet, u) * tet.alpha.transpose();
    const Mat3<double> stress =
        tet.lambda * H.trace() * Mat3<double>::Identity() + tet.mu * (H + H.transpose());
    for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= tet.V * (stress * tet.alpha.col(j));
  }
}

void add_reference_volume_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& x, double kappa,
                                 Mat3X<double>& f) {
  for (const ReferenceTet& tet : tets) {
    const double v = (edges(x, tet.corners).determinant() / 6 - tet.V) / tet.V;
    for (int p = 0; p < 4; ++p) {
      const Vec3d a = x.col(tet.corners[face_corners[p][0]]), b = x.col(tet.corners[face_corners[p][1]]),
                  c = x.col(tet.corners[face_corners[p][2]]);
      const Vec3d volume_gradient = (c - a).cross(b - a) / 6;  // a third of the face, towards p
      f.col(tet.corners[p]) -= kappa * v * std::abs(v) * volume_gradient;
    }
  }
}

void add_reference_nodal_pressure_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                         Mat3X<double>& f) {
  const Mat3<double> I = Mat3<double>::Identity();
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(u.cols()), strain = volume;  // V_n, V_n θ_n
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> F = deformation(tet, u);
    for (Index n : tet.corners) {
      volume[n] += tet.V / 4;
      strain[n] += tet.V / 4 * 0.5 * (F.transpose() * F - I).trace();
    }
  }
  for (const ReferenceTet& tet : tets) {
    double p = 0;
    for (Index n : tet.corners) p += tet.lambda * strain[n] / volume[n] / 4;
    const Mat3<double> F = deformation(tet, u);
    const Mat3<double> S = p * I + tet.mu * (F.transpose() * F - I);
    for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= tet.V * (F * S * tet.alpha.col(j));
  }
}

void add_reference_smoothed_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                   bool nodal_pressure, Mat3X<double>& f) {
  struct Domain {
    double V = 0;
    Mat3<double> VF = Mat3<double>::Zero(), E, F;
  };
  const Mat3<double> I = Mat3<double>::Identity();
  std::map<std::pair<Index, Index>, Domain> domains;
  const auto for_edges = [&](const ReferenceTet& tet, auto&& visit) {
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const std::pair<Index, Index> edge = std::minmax(tet.corners[i], tet.corners[j]);
        visit(edge, domains[edge]);
      }
  };
  for (const ReferenceTet& tet : tets)
    for_edges(tet, [&](const auto&, Domain& domain) {
      domain.V += tet.V / 6;
      domain.VF += tet.V / 6 * deformation(tet, u);
    });
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(u.cols()), strain = volume;  // V_n, V_n θ_n
  for (auto& [edge, domain] : domains) {
    domain.F = domain.VF / domain.V;
    domain.E = 0.5 * (domain.F.transpose() * domain.F - I);
    for (Index n : {edge.first, edge.second}) {
      volume[n] += domain.V / 2;
      strain[n] += domain.V / 2 * domain.E.trace();
    }
  }
  for (const ReferenceTet& tet : tets)
    for_edges(tet, [&](const auto& edge, const Domain& domain) {
      const double mean =
          strain[edge.first] / volume[edge.first] / 2 + strain[edge.second] / volume[edge.second] / 2;
      const double trace = nodal_pressure ? mean : domain.E.trace();
      const Mat3<double> S = tet.lambda * trace * I + 2 * tet.mu * domain.E;
      for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= tet.V / 6 * (domain.F * S * tet.alpha.col(j));
    });
}

void add_reference_fibre_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                const FibreModuli<double>& fibre, const Vec3d& a, Mat3X<double>& f) {
  const Mat3<double> I = Mat3<double>::Identity(), A = a * a.transpose();
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> F = deformation(tet, u);
    const Mat3<double> E = 0.5 * (F.transpose() * F - I);
    const double along = a.dot(E * a);
    const Mat3<double> S = fibre.coupling * (along * I + E.trace() * A) + 2 * fibre.shear * (A * E + E * A) +
                           fibre.stretch * along * A;
    const Mat34<double> g = tet.V * (F * S) * tet.alpha;
    for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= g.col(j);
  }
}

void add_reference_neo_hookean_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                      Mat3X<double>& f) {
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> F = deformation(tet, u);
    const Mat3<double> cofactor = F.determinant() * F.inverse().transpose();
    const Mat3<double> P = tet.mu * (F - cofactor) + (tet.lambda + tet.mu) * (F.determinant() - 1) * cofactor;
    const Mat34<double> g = tet.V * P * tet.alpha;
    for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= g.col(j);
  }
}

void add_reference_yeoh_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                               const std::array<double, 2>& c, Mat3X<double>& f) {
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> F = deformation(tet, u), inverse = F.inverse().transpose();
    const double J = F.determinant(), phi = std::pow(J, -2.0 / 3), I1 = F.squaredNorm(), q = phi * I1 - 3;
    const double slope = tet.mu / 2 + 2 * c[0] * q + 3 * c[1] * q * q, K = tet.lambda + 2 * tet.mu / 3;
    const Mat3<double> P = 2 * slope * phi * (F - I1 / 3 * inverse) + K * (J - 1) * J * inverse;
    const Mat34<double> g = tet.V * P * tet.alpha;
    for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= g.col(j);
  }
}

void add_reference_mooney_rivlin_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                        double c01, Mat3X<double>& f) {
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> F = deformation(tet, u), inverse = F.inverse().transpose(), C = F.transpose() * F;
    const double J = F.determinant(), phi = std::pow(J, -2.0 / 3), I1 = C.trace(),
                 I2 = (I1 * I1 - C.squaredNorm()) / 2, K = tet.lambda + 2 * tet.mu / 3;
    const Mat3<double> P = (tet.mu - 2 * c01) * phi * (F - I1 / 3 * inverse) +
                           2 * c01 * phi * phi * (I1 * F - F * C - 2 * I2 / 3 * inverse) +
                           K * (J - 1) * J * inverse;
    const Mat34<double> g = tet.V * P * tet.alpha;
    for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= g.col(j);
  }
}

void add_reference_holzapfel_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                    const std::array<double, 2>& k, const std::array<Vec3d, 2>& families,
                                    Mat3X<double>& f) {
  add_reference_mooney_rivlin_forces(tets, u, 0, f);
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> F = deformation(tet, u);
    for (const Vec3d& a : families) {
      const double E = std::max((F * a).squaredNorm() - 1, 0.0);
      const Mat3<double> P = 2 * k[0] * E * std::exp(k[1] * E * E) * F * a * a.transpose();
      const Mat34<double> g = tet.V * P * tet.alpha;
      for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= g.col(j);
    }
  }
}

void add_reference_corotational_forces(const std::vector<ReferenceTet>& tets, const Mat3X<double>& u,
                                       Mat3X<double>& f) {
  for (const ReferenceTet& tet : tets) {
    const Mat3<double> F = deformation(tet, u);
    const Eigen::JacobiSVD<Mat3<double>> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3<double> U = svd.matrixU();
    if (F.determinant() < 0) U.col(2) = -U.col(2);
    const Mat3<double> R = U * svd.matrixV().transpose();
    const double trace = R.cwiseProduct(F).sum() - 3;
    const Mat34<double> g = tet.V * (2 * tet.mu * (F - R) + tet.lambda * trace * R) * tet.alpha;
    for (int j = 0; j < 4; ++j) f.col(tet.corners[j]) -= g.col(j);
  }
}

}  // namespace lobe::bench
