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

namespace {

const Vec3d first_side(0.6, 0, 0.8), second_side(0, 1, 0);

Mat3<double> symmetric(const Mat3<double>& M) { return (M + M.transpose()) / 2; }

double product(const Mat3<double>& A, const Mat3<double>& B) { return A.cwiseProduct(B).sum(); }

// The part of S_fibre that is linear in A, without the term of β.
Mat3<double> without_stretch(const FibreModuli<double>& f, const Mat3<double>& E, const Mat3<double>& A) {
  return f.coupling * (product(A, E) * Mat3<double>::Identity() + E.trace() * A) +
         2 * f.shear * (A * E + E * A);
}

Mat3<double> fibre_stress(const FibreModuli<double>& f, const Mat3<double>& E, const Mat3<double>& A) {
  return without_stretch(f, E, A) + f.stretch * product(A, E) * A;
}

Mat3<double> fibre_stress_derivative(const FibreModuli<double>& f, const Mat3<double>& E,
                                     const Mat3<double>& A, const Mat3<double>& dE, const Mat3<double>& dA) {
  return fibre_stress(f, dE, A) + without_stretch(f, E, dA) +
         f.stretch * (product(dA, E) * A + product(A, E) * dA);
}

}  // namespace

Vec3d Law::direction(const Vec3d& X) const {
  return std::cos(turn.dot(X)) * first_side + std::sin(turn.dot(X)) * second_side;
}

Mat3<double> Law::stress(const Mat3<double>& H, const Vec3d& X) const {
  const Vec3d a = direction(X);
  const Mat3<double> A = a * a.transpose();
  if (model == RegionModel::tensor_mass)
    return hooke_stress(H, lambda, mu) + fibre_stress(fibre, symmetric(H), A);
  const Mat3<double> F = Mat3<double>::Identity() + H;
  return svk_stress(H, lambda, mu) + volume_stress(H, volume_penalty) +
         F * fibre_stress(fibre, green_strain(H), A);
}

Mat3<double> Law::stress_derivative(const Mat3<double>& H, const Mat3<double>& dH, const Vec3d& X,
                                    int j) const {
  const Mat3<double> I = Mat3<double>::Identity();
  const Vec3d a = direction(X);
  const Vec3d da = turn[j] * (std::cos(turn.dot(X)) * second_side - std::sin(turn.dot(X)) * first_side);
  const Mat3<double> A = a * a.transpose(), dA = da * a.transpose() + a * da.transpose();
  if (model == RegionModel::tensor_mass)
    return lambda * dH.trace() * I + mu * (dH + dH.transpose()) +
           fibre_stress_derivative(fibre, symmetric(H), A, symmetric(dH), dA);
  const Mat3<double> F = I + H, E = green_strain(H), dE = symmetric(F.transpose() * dH);
  const Mat3<double> C = cofactor(F), dC = cofactor<double>(F + dH) - C - cofactor(dH);
  const double v = volume_change(H);
  return dH * (svk_second_stress(H, lambda, mu) + fibre_stress(fibre, E, A)) +
         F * (lambda * dE.trace() * I + 2 * mu * dE + fibre_stress_derivative(fibre, E, A, dE, dA)) +
         2 * volume_penalty * std::abs(v) * C.cwiseProduct(dH).sum() * C +
         volume_penalty * v * std::abs(v) * dC;
}

Vec3d body_force(const ExactField& field, const Law& law, const Vec3d& X) {
  const Mat3<double> H = field.gradient(X);
  const std::array<Mat3<double>, 3> dH = field.gradient_derivatives(X);
  Vec3d b = Vec3d::Zero();
  for (int j = 0; j < 3; ++j) b -= law.stress_derivative(H, dH[j], X, j).col(j);
  return b;
}

}  // namespace lobe::validation
