#include "lobe/numerics/lanczos.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

namespace lobe {
namespace {

struct Ritz {
  double value = 0, residual = 0;  // an eigenvalue is within the residual of the value
};

// The largest eigenvalue of the tridiagonal matrix with this diagonal and these off-diagonals. The last of
// these couples it to the next iteration.
Ritz largest_ritz(const std::vector<double>& alpha, const std::vector<double>& beta) {
  const auto m = static_cast<Eigen::Index>(alpha.size());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(alpha.data(), m),
                                Eigen::Map<const Eigen::VectorXd>(beta.data(), m - 1));
  if (solver.info() == Eigen::Success)
    return {solver.eigenvalues()[m - 1], std::abs(beta.back() * solver.eigenvectors()(m - 1, m - 1))};
  double bound = 0;  // Gershgorin
  for (Eigen::Index i = 0; i < m; ++i)
    bound = std::max(bound, alpha[i] + beta[i] + (i > 0 ? beta[i - 1] : 0));
  return {bound, 0};
}

// f_v = ± √m_v (ω_v²/ω²)^power.
template <class Real>
Mat3X<Real> start_vector(const std::vector<double>& inverse_mass, const std::function<double(Index)>& square,
                         double power) {
  const auto n = static_cast<Index>(inverse_mass.size());
  double largest = 0;
  for (Index v = 0; v < n; ++v) largest = std::max(largest, square(v));
  Mat3X<Real> q = Mat3X<Real>::Zero(3, n);
  std::minstd_rand random;
  for (Index v = 0; v < n; ++v) {
    const double size =
        inverse_mass[v] > 0 ? std::pow(square(v) / largest, power) / std::sqrt(inverse_mass[v]) : 0;
    for (int d = 0; d < 3; ++d) q(d, v) = Real(random() % 2 == 0 ? size : -size);
  }
  return q;
}

}  // namespace

// Lanczos iterations of K C in the inner product of C, on forces q; u = C q.
template <class Real>
HighestFrequency highest_frequency(const std::vector<double>& inverse_mass,
                                   const std::function<double(Index)>& square, double small,
                                   const std::function<void(const Mat3X<Real>&, Mat3X<Real>&)>& add_forces,
                                   const LanczosSettings& settings,
                                   const std::function<void(Mat3X<Real>&)>& scale) {
  const auto n = static_cast<Eigen::Index>(inverse_mass.size());
  Eigen::Array<Real, 1, Eigen::Dynamic> inverse(n);
  for (Eigen::Index v = 0; v < n; ++v) inverse[v] = static_cast<Real>(inverse_mass[v]);
  if (n == 0 || !(inverse.maxCoeff() > 0)) return {};
  const auto accelerated = [&](const Mat3X<Real>& f) -> Mat3X<Real> {
    Mat3X<Real> a = f;
    if (scale) scale(a);
    a.array().rowwise() *= inverse;
    return a;
  };
  const auto product = [](const Mat3X<Real>& a, const Mat3X<Real>& b) {
    return a.cwiseProduct(b).template cast<double>().sum();
  };
  Mat3X<Real> q = start_vector<Real>(inverse_mass, square, scale ? 0 : 4), previous = Mat3X<Real>::Zero(3, n),
              w(3, n);
  Mat3X<Real> u = accelerated(q);
  {
    const Real norm = Real(std::sqrt(product(q, u)));
    q /= norm;
    u /= norm;
  }
  std::vector<double> alpha, beta;
  Ritz ritz;
  HighestFrequency found;
  do {
    const Real size = static_cast<Real>(small) / u.cwiseAbs().maxCoeff();
    w.setZero();
    add_forces(u * size, w);
    w /= -size;
    if (!beta.empty()) w -= Real(beta.back()) * previous;
    alpha.push_back(product(w, u));
    w -= Real(alpha.back()) * q;
    u = accelerated(w);
    beta.push_back(std::sqrt(std::max(0.0, product(w, u))));
    previous.swap(q);
    q = w / Real(beta.back());
    u /= Real(beta.back());
    found.evaluations = static_cast<int>(alpha.size());
    const bool is_last = found.evaluations == settings.most || !(beta.back() > 1e-6 * alpha.front());
    if (found.evaluations % 4 > 0 && !is_last) continue;
    ritz = largest_ritz(alpha, beta);
    found.converged = ritz.residual <= 2 * settings.tolerance * ritz.value;
    if (is_last) break;
  } while (found.evaluations % 4 > 0 || !found.converged);
  found.omega = std::sqrt(ritz.value + ritz.residual);
  return found;
}

template HighestFrequency highest_frequency(const std::vector<double>&, const std::function<double(Index)>&,
                                            double,
                                            const std::function<void(const Mat3X<float>&, Mat3X<float>&)>&,
                                            const LanczosSettings&,
                                            const std::function<void(Mat3X<float>&)>&);
template HighestFrequency highest_frequency(const std::vector<double>&, const std::function<double(Index)>&,
                                            double,
                                            const std::function<void(const Mat3X<double>&, Mat3X<double>&)>&,
                                            const LanczosSettings&,
                                            const std::function<void(Mat3X<double>&)>&);

}  // namespace lobe
