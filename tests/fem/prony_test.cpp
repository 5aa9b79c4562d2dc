// Viscosity by a Prony series: the step against closed forms of one element.
#include "lobe/fem/prony.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "fem/moduli.h"
#include "lobe/fem/svk.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const std::array<PronyTerm, 2> two_terms{PronyTerm{0.3, 0.1, 0.05}, PronyTerm{0.2, 0.25, 0.8}};
const ViscousModulus viscous_shear{mu, two_terms};

// All branches of an element whose strain is given from step to step.
class ViscousElement {
 public:
  explicit ViscousElement(double step) {
    for (std::size_t i = 0; i < two_terms.size(); ++i)
      branches_.push_back(viscous_branch(two_terms, i, lambda, mu, step));
    A_.assign(branches_.size(), Mat3<double>::Zero());
  }
  // S [Pa] beyond the slow one at this strain; then half a step passes before, and half a step after.
  Mat3<double> follow(const Mat3<double>& E) {
    Mat3<double> S = Mat3<double>::Zero();
    for (std::size_t i = 0; i < A_.size(); ++i) {
      S += viscous_stress(E, A_[i], branches_[i]);
      A_[i] = followed_strain(E, A_[i], branches_[i]);
    }
    return S;
  }

 private:
  std::vector<ViscousBranch<double>> branches_;
  std::vector<Mat3<double>> A_;
};

Mat3<double> shear_strain(double e) {
  Mat3<double> E = Mat3<double>::Zero();
  E(0, 1) = E(1, 0) = e / 2;
  return E;
}
double shear_stress(ViscousElement& element, double e) {
  return mu * e + element.follow(shear_strain(e))(0, 1);
}

// The largest error of a vibration's shear stress over a period, after it has settled.
double error_of_vibration(double omega, int steps_per_period) {
  const double h = 2 * std::numbers::pi / (omega * steps_per_period);
  const int settled =
      int(12 * two_terms[1].time / h) / steps_per_period * steps_per_period + steps_per_period;
  ViscousElement element(h);
  double error = 0;
  for (int n = 0; n < settled + steps_per_period; ++n) {
    const double phase = omega * n * h, stress = shear_stress(element, std::sin(phase));
    const double exact =
        viscous_shear.storage(omega) * std::sin(phase) + viscous_shear.loss(omega) * std::cos(phase);
    if (n >= settled) error = std::max(error, std::abs(stress - exact));
  }
  return error / mu;
}

}  // namespace

TEST_CASE("after a sudden strain stress relaxes by the series, in shear and in volume, at any step") {
  const ViscousModulus bulk{lambda + 2 * mu / 3, two_terms, &PronyTerm::bulk};
  for (double h : {1e-3, 0.05, 3.0}) {
    ViscousElement sheared_one(h), swollen(h);
    for (int n = 0; n < 40; ++n) {
      const double t = (n + 0.5) * h;  // half a step has passed at the first
      CAPTURE(t);
      CHECK(shear_stress(sheared_one, 0.1) == near(0.1 * viscous_shear.relaxed(t), 1e-12));
      const Mat3<double> S = swollen.follow(0.01 * Mat3<double>::Identity());
      CHECK(S(0, 0) + 0.03 * bulk.slow == near(0.03 * bulk.relaxed(t), 1e-12));
      CHECK(std::abs(S(0, 1)) == 0);
    }
  }
  CHECK(viscous_shear.relaxed(0) == near(mu / 0.5, 1e-14));
  CHECK(viscous_shear.relaxed(1e3) == near(mu, 1e-14));
}

TEST_CASE("storage and loss modulus are those of the series over four decades, at order 2 of the step") {
  for (double omega : {0.1, 1.0, 10.0, 100.0, 1000.0}) {
    CAPTURE(omega);
    CHECK(error_of_vibration(omega, 60) < 0.01);
    const int steps = std::max(60, int(2 * std::numbers::pi / (omega * two_terms[0].time / 4)));
    CHECK(std::log2(error_of_vibration(omega, steps) / error_of_vibration(omega, 2 * steps)) ==
          near(2, 0.03));
  }
}

TEST_CASE("under a constant stress one branch creeps as the standard linear solid") {
  const std::array<PronyTerm, 1> one{PronyTerm{0.6, 0, 0.2}};
  const ViscousModulus modulus{mu, one};
  const double stress = 100, whole = modulus.relaxed(0), creep_time = 0.2 * whole / mu;
  const auto error_with = [&](double h) {
    const ViscousBranch<double> branch = viscous_branch(one, 0, lambda, mu, h);
    Mat3<double> A = Mat3<double>::Zero();
    double error = 0;
    for (int n = 0; n * h < 2; ++n) {  // the e at which the stress is the given one
      const double unit = viscous_stress<double>(shear_strain(1), Mat3<double>::Zero(), branch)(0, 1),
                   of_A = viscous_stress<double>(Mat3<double>::Zero(), A, branch)(0, 1),
                   e = (stress - of_A) / (mu + unit);
      const double exact =
          stress / mu - (stress / mu - stress / whole) * std::exp(-(n + 0.5) * h / creep_time);
      error = std::max(error, std::abs(e - exact) * mu / stress);
      A = followed_strain(shear_strain(e), A, branch);
    }
    return error;
  };
  CHECK(error_with(0.01) < 2e-4);
  CHECK(std::log2(error_with(0.01) / error_with(0.005)) == near(2, 0.03));
}

TEST_CASE("a cycle of strain loses pi G'' of its squared amplitude") {
  const double omega = 4, amplitude = 0.2,
               exact = std::numbers::pi * viscous_shear.loss(omega) * amplitude * amplitude;
  const int steps = 400;
  const double h = 2 * std::numbers::pi / (omega * steps);
  ViscousElement element(h);
  double lost = 0;
  for (int n = 0; n < 10 * steps; ++n) {
    const double phase = omega * n * h, rate = amplitude * omega * std::cos(phase),
                 stress = shear_stress(element, amplitude * std::sin(phase));
    if (n >= 9 * steps) lost += stress * rate * h;
  }
  CHECK(lost == near(exact, 2e-4));
}

TEST_CASE("a rotation of any speed meets no viscosity") {
  ViscousElement element(0.01);
  for (int n = 0; n < 50; ++n) {
    const double angle = 0.3 * n, c = std::cos(angle), s = std::sin(angle);
    Mat3<double> H;
    H << c - 1, -s, 0, s, c - 1, 0, 0, 0, 0;
    CHECK(element.follow(green_strain(H)).norm() < 1e-11 * mu);
  }
}

TEST_CASE("a step is never stiffer than the solid at once") {
  for (double h : {1e-6, 0.01, 1.0, 100.0}) {
    ViscousElement element(h);
    CHECK(shear_stress(element, 1) <= viscous_shear.relaxed(0));
    CHECK(shear_stress(element, 1) >= mu);
  }
}

TEST_CASE("a series that is none is named") {
  const auto fault = [](std::vector<PronyTerm> series) { return std::string(prony_fault(series)); };
  CHECK(fault({}).empty());
  CHECK(fault({{0.3, 0.1, 0.05}, {0.6, 0, 2}}).empty());
  CHECK(fault({{0.3, 0, 0}}).find("time") != std::string::npos);
  CHECK(fault({{0.3, 0, -1}}).find("time") != std::string::npos);
  CHECK(fault({{0.3, 0, std::nan("")}}).find("time") != std::string::npos);
  CHECK(fault({{0, 0, 1}}).find("needs a share") != std::string::npos);
  CHECK(fault({4, PronyTerm{0.1, 0, 1}}).find("at most 3") != std::string::npos);
  CHECK(fault({{-0.1, 0, 1}}).find("at least 0") != std::string::npos);
  CHECK(fault({{0.5, 0, 1}, {0.5, 0, 2}}).find("shares of shear") != std::string::npos);
  CHECK(fault({{0, 1.2, 1}}).find("shares of bulk") != std::string::npos);
}
