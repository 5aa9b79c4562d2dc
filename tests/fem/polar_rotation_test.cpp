// The rotation of a deformation gradient, against Eigen's singular value decomposition.
#include "lobe/fem/polar_rotation.h"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <random>

#include "lobe/numerics/simd.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// s₁, s₂ and s₃, which is negative where det F is, of |F|² = 3.
Vec3d stretches(const Mat3<double>& F) {
  Vec3d s = Eigen::JacobiSVD<Mat3<double>>(F).singularValues();
  if (F.determinant() < 0) s[2] = -s[2];
  return s * std::sqrt(3.0) / F.norm();
}

Mat3<double> exact_rotation(const Mat3<double>& F) {
  const Eigen::JacobiSVD<Mat3<double>> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3<double> U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

// Rotations of any angle times I + size × numbers from −1 to 1, which Real has exactly.
template <class Real>
std::vector<Mat3<double>> random_gradients(double size, int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Mat3<double>> found;
  for (int i = 0; i < count; ++i) {
    Mat3<double> turn, strain;
    for (double& x : turn.reshaped()) x = uniform(random);
    for (double& x : strain.reshaped()) x = uniform(random);
    const Mat3<double> F = exact_rotation(turn) * (Mat3<double>::Identity() + size * strain);
    found.push_back(F.cast<Real>().template cast<double>());
  }
  return found;
}

template <class Real>
std::vector<Mat3<double>> rotations(const std::vector<Mat3<double>>& gradients) {  // a register at a time
  using T = Pack<Real>;
  std::vector<Mat3<double>> found;
  for (std::size_t first = 0; first < gradients.size(); first += T::size()) {
    const std::size_t used = std::min(T::size(), gradients.size() - first);
    Mat3<T> F;
    for (int i = 0; i < 9; ++i)
      F(i) = T([&](int lane) { return Real(gradients[first + std::size_t(lane) % used](i)); });
    const Mat3<T> R = polar_rotation(F);
    for (std::size_t lane = 0; lane < used; ++lane) {
      Mat3<double>& own = found.emplace_back();
      for (int i = 0; i < 9; ++i) own(i) = double(R(i)[lane]);
    }
  }
  return found;
}

template <class Real>
double largest_error(double size) {
  const std::vector<Mat3<double>> gradients = random_gradients<Real>(size, 4000);
  const std::vector<Mat3<double>> found = rotations<Real>(gradients);
  double largest = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    largest = std::max(largest, (found[i] - exact_rotation(gradients[i])).cwiseAbs().maxCoeff());
  return largest;
}

template <class Real>
std::vector<Mat3<double>> hard_gradients() {
  std::vector<Mat3<double>> hard;
  for (const Vec3d& s : {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(1, 1, 0), Vec3d(1, 1, -1), Vec3d(2, 1, -1),
                         Vec3d(1, 1e-3, -1e-3), Vec3d(-1, -1, -1), Vec3d(1e-12, 1e-12, 1e-12),
                         Vec3d(1e10, 1e10, 1e9), Vec3d(1e-20, 0, 0)})
    for (const Mat3<double>& turn : random_gradients<Real>(0, 3)) {
      hard.push_back(s.asDiagonal());
      hard.push_back(
          (turn * s.asDiagonal() * turn.transpose()).template cast<Real>().template cast<double>());
    }
  return hard;
}

}  // namespace

TEST_CASE("the rotation is that of a singular value decomposition, turned and strained far") {
  for (double size : {1e-6, 1e-3, 0.05, 0.2}) {
    CAPTURE(size);
    CHECK(largest_error<float>(size) < 1e-6);
    CHECK(largest_error<double>(size) < 1e-14);
  }
  CHECK(largest_error<double>(0.5) < 1e-12);  // some are inverted
}

// The conditioning of the rotation itself: R turns by δ/(s₂ + s₃) if F changes by δ.
TEST_CASE_TEMPLATE("its error is that of a rounding of F, however crushed or inverted a tetrahedron is", Real,
                   float, double) {
  int inverted = 0;
  for (double size : {0.5, 1.0, 2.0, 1e3}) {
    const std::vector<Mat3<double>> gradients = random_gradients<Real>(size, 4000);
    const std::vector<Mat3<double>> found = rotations<Real>(gradients);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Vec3d s = stretches(gradients[i]);
      const double error = (found[i] - exact_rotation(gradients[i])).cwiseAbs().maxCoeff();
      CHECK(error * (s[1] + s[2]) < 24 * std::numeric_limits<Real>::epsilon());
      inverted += s[2] < 0;
    }
  }
  CHECK(inverted > 1000);
}

TEST_CASE_TEMPLATE("it is a rotation for every gradient, also where two are as near", Real, float, double) {
  const std::vector<Mat3<double>> hard = hard_gradients<Real>();
  const std::vector<Mat3<double>> found = rotations<Real>(hard);
  const double rounding = 8 * std::numeric_limits<Real>::epsilon();
  for (std::size_t i = 0; i < hard.size(); ++i) {
    CAPTURE(hard[i]);
    CHECK((found[i].transpose() * found[i] - Mat3<double>::Identity()).norm() < rounding);
    CHECK(found[i].determinant() == near(1, rounding));
    const double most = exact_rotation(hard[i]).cwiseProduct(hard[i]).sum();
    CHECK(found[i].cwiseProduct(hard[i]).sum() == near(most, 1e-5, hard[i].norm() + 1e-300));
  }
}

TEST_CASE("no gradient at rest is turned, to the last bit") {
  CHECK(polar_rotation<double>(Mat3<double>::Identity()) == Mat3<double>::Identity());
  CHECK(rotations<float>({Mat3<double>::Identity()})[0] == Mat3<double>::Identity());
  CHECK(polar_rotation<double>(Mat3<double>::Zero()) == Mat3<double>::Identity());
}

TEST_CASE("a lane's rotation does not depend on its neighbours, one of which needs the quaternion") {
  const std::vector<Mat3<double>> gradients = random_gradients<float>(0.3, 4 * int(Pack<float>::size()));
  std::vector<Mat3<double>> mixed = gradients;
  for (std::size_t i = 0; i < mixed.size(); i += 3) mixed[i] = Vec3d(1, 1, -1).asDiagonal();
  const std::vector<Mat3<double>> alone = rotations<float>(gradients), beside = rotations<float>(mixed);
  for (std::size_t i = 0; i < mixed.size(); ++i)
    if (i % 3 != 0) CHECK(alone[i] == beside[i]);
}
