#include "benchmarks/validation/exact_field.h"

#include <cmath>

#include "lobe/fem/hooke.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"

namespace lobe::validation {

Vec3d ExactField::displacement(const Vec3d& X) const {
  const Vec3d p = X - centre;
  return amplitude * Vec3d(p.z() * std::exp(p.x()), p.x() * std::exp(p.y()), p.y() * std::exp(p.z()));
}

// u_i = a p_k exp(p_i), k = i − 1 cyclically
Mat3<double> ExactField::gradient(const Vec3d& X) const {
  const Vec3d p = X - centre, e = p.array().exp();
  Mat3<double> H = Mat3<double>::Zero();
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 2) % 3;
    H(i, i) = p[k] * e[i];
    H(i, k) = e[i];
  }
  return amplitude * H;
}

std::array<Mat3<double>, 3> ExactField::gradient_derivatives(const Vec3d& X) const {
  const Vec3d p = X - centre, e = p.array().exp();
  std::array<Mat3<double>, 3> dH;
  dH.fill(Mat3<double>::Zero());
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 2) % 3;
    dH[i](i, i) = amplitude * p[k] * e[i];
    dH[k](i, i) = amplitude * e[i];
    dH[i](i, k) = amplitude * e[i];
  }
  return dH;
}

Mat3<double> Law::stress(const Mat3<double>& H) const {
  if (model == RegionModel::tensor_mass) return hooke_stress(H, lambda, mu);
  return svk_stress(H, lambda, mu) + volume_stress(H, volume_penalty);
}

Mat3<double> Law::stress_derivative(const Mat3<double>& H, const Mat3<double>& dH) const {
  const Mat3<double> I = Mat3<double>::Identity();
  if (model == RegionModel::tensor_mass) return lambda * dH.trace() * I + mu * (dH + dH.transpose());
  const Mat3<double> F = I + H, FtdH = F.transpose() * dH, dE = (FtdH + FtdH.transpose()) / 2;
  const Mat3<double> C = cofactor(F), dC = cofactor<double>(F + dH) - C - cofactor(dH);
  const double v = volume_change(H);
  return dH * svk_second_stress(H, lambda, mu) + F * (lambda * dE.trace() * I + 2 * mu * dE) +
         2 * volume_penalty * std::abs(v) * C.cwiseProduct(dH).sum() * C +
         volume_penalty * v * std::abs(v) * dC;
}

Vec3d body_force(const ExactField& field, const Law& law, const Vec3d& X) {
  const Mat3<double> H = field.gradient(X);
  const std::array<Mat3<double>, 3> dH = field.gradient_derivatives(X);
  Vec3d b = Vec3d::Zero();
  for (int j = 0; j < 3; ++j) b -= law.stress_derivative(H, dH[j]).col(j);
  return b;
}

}  // namespace lobe::validation
