#include "lobe/fem/law.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "lobe/fem/shape.h"
#include "lobe/numerics/simd.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double nodal_lambda = 3e4;

std::vector<Terms> all_combinations() {
  std::vector<Terms> solids{{.solid = MaterialLaw::none, .fibre = true}, {.fibre = true}};
  for (int solid = 0; solid <= int(MaterialLaw::none); ++solid)
    solids.push_back({.solid = MaterialLaw(solid)});
  std::vector<Terms> all;
  for (Terms terms : solids)
    for (bool volume : {false, true})
      for (bool pressure : {false, true})
        for (bool guard : {false, true}) {
          terms.volume = volume;
          terms.pressure = pressure;
          terms.guard = guard;
          all.push_back(terms);
        }
  return all;
}

int count(const Terms& terms) {
  return (terms.solid != MaterialLaw::none) + terms.volume + terms.pressure + terms.guard + terms.fibre;
}

std::string name(const Terms& terms) {
  const std::size_t solid = std::size_t(terms.solid);
  return (terms.solid == MaterialLaw::none
              ? ""
              : std::string(solid < law_count ? law_rows[solid].name : "corotational") + " ") +
         (terms.volume ? "volume " : "") + (terms.pressure ? "pressure " : "") +
         (terms.guard ? "guard " : "") + (terms.fibre ? "fibre " : "");
}

constexpr FibreModuli<double> fibre_moduli{3e3, 8e3, 5e4};
Vec3d fibre_direction() { return Vec3d(2, -1, 0.5).normalized(); }

// With the nodal pressure of a body whose gradient is the same everywhere, so that there is an energy of H
// alone.
Law<double> law_at(const Terms& terms, const Mat3<double>& H) {
  return {.lambda = 1e4,
          .mu = 1.5e4,
          .kappa = 2e5,
          .pressure = nodal_lambda * pressure_strain(H, terms.solid),
          .guard_modulus = 4e4,
          .guard_threshold = 0.8,
          .terms = terms,
          .fibre = fibre_moduli,
          .direction = fibre_direction(),
          .further = {terms.solid == MaterialLaw::yeoh ? -2e3 : 3e3, 6e3},
          .families = {.stiffening = 2, .most = 0.7, .along = 0.8, .aside = 0.6, .plane = {0.2, 3, -1}}};
}

// Stretched, where the guard is silent; at det F = 0.61, in the guard's first branch; inverted, in its
// second.
std::vector<Mat3<double>> states() {
  Mat3<double> H;
  H << 0.15, -0.2, 0.1, 0.25, 0.2, -0.15, -0.1, 0.2, 0.1;
  Mat3<double> crushed = H;
  crushed(2, 2) = -0.5;
  Mat3<double> inverted = H;
  inverted(2, 2) = -1.2;
  return {H, crushed, inverted};
}

const Mat3<double> direction = (Mat3<double>() << 0.4, -0.9, 0.3, 0.7, 0.5, -0.2, -0.6, 0.1, 0.8).finished();

Mat34<double> gradients() {
  return shape((Mat34<double>() << 0, 0.9, 0.1, 0.2, 0, 0.2, 1.1, 0.1, 0, -0.1, 0.2, 0.8).finished())
      .gradients;
}

// That `slope` is the derivative of f at 0: the error of central differences falls like h², or is but
// rounding.
template <class F>
void check_derivative(const F& f, const Eigen::VectorXd& slope) {
  const auto error = [&](double h) { return ((f(h) - f(-h)) / (2 * h) - slope).norm() / slope.norm(); };
  const double wide = error(1e-3), narrow = error(5e-4);
  CHECK(narrow < 1e-3);
  if (narrow > 1e-10) CHECK(std::log2(wide / narrow) == near(2, 0.03));
}

// p ∂²J/∂u_j∂u_k: the columns of P = p cof F, differentiated exactly, since they are of degree 2 in F.
Eigen::Matrix<double, 12, 12> volume_stiffness(double p, const Mat3<double>& H, const Mat34<double>& alpha) {
  Eigen::Matrix<double, 12, 12> K;
  for (int i = 0; i < 12; ++i) {
    Mat34<double> w = Mat34<double>::Zero();
    w(i) = 1;
    const Mat3<double> turn = w * alpha.transpose(), back = H - turn, forth = H + turn;
    K.col(i) = (p / 2 * (deformation_cofactor(forth) - deformation_cofactor(back)) * alpha).reshaped();
  }
  return K;
}

Eigen::VectorXd number(double x) { return Eigen::VectorXd::Constant(1, x); }

}  // namespace

TEST_CASE("the three states are stretched, crushed and inverted") {
  std::vector<double> ratios;
  for (const Mat3<double>& H : states()) ratios.push_back(1 + volume_change(H));
  CHECK(ratios[0] > 1.2);
  CHECK(ratios[1] > 0.2);  // the end of the guard's first branch
  CHECK(ratios[1] < 0.8);
  CHECK(ratios[2] < 0);
}

TEST_CASE("the stress is the derivative of the energy, whatever the terms") {
  for (const Terms& terms : all_combinations())
    for (const Mat3<double>& H : states()) {
      CAPTURE(name(terms));
      const Mat3<double> P = law_stress(law_at(terms, H), H);
      if (P.isZero(0)) continue;
      check_derivative(
          [&](double h) {
            const Mat3<double> moved = H + h * direction;
            return number(law_energy_density(law_at(terms, moved), moved));
          },
          number(P.cwiseProduct(direction).sum()));
    }
}

TEST_CASE("the stiffness is the derivative of the stress at given nodal pressure, whatever the terms") {
  const Mat34<double> alpha = gradients(), w = random_displacement(4, 1);
  const Mat3<double> turn = w * alpha.transpose();
  for (const Terms& terms : all_combinations())
    for (const Mat3<double>& H : states()) {
      CAPTURE(name(terms));
      const Law<double> law = law_at(terms, H);
      const Eigen::VectorXd slope = law_stiffness(law, H, alpha) * w.reshaped();
      if (slope.isZero(0)) continue;
      check_derivative(
          [&](double h) -> Eigen::VectorXd {
            return (law_stress<double>(law, H + h * turn) * alpha).reshaped();
          },
          slope);
    }
}

TEST_CASE("the diagonal block is that of the stiffness, whatever the terms") {
  const Mat34<double> alpha = gradients();
  for (const Terms& terms : all_combinations())
    for (const Mat3<double>& H : states()) {
      CAPTURE(name(terms));
      const Law<double> law = law_at(terms, H);
      const Eigen::Matrix<double, 12, 12> K = law_stiffness(law, H, alpha);
      CHECK((K - K.transpose()).norm() <= 1e-14 * K.norm());
      for (int c = 0; c < 4; ++c) {
        const Mat3<double> block = law_diagonal_block<double>(law, H, alpha.col(c));
        CHECK((K.block<3, 3>(3 * c, 3 * c) - block).norm() <= 1e-13 * K.norm());
      }
    }
}

TEST_CASE("a law is the sum of its terms, and nothing without any") {
  const Mat34<double> alpha = gradients();
  for (const Mat3<double>& H : states())
    for (const Terms& terms : all_combinations()) {
      CAPTURE(name(terms));
      double W = 0;
      Mat3<double> P = Mat3<double>::Zero();
      Eigen::Matrix<double, 12, 12> K = Eigen::Matrix<double, 12, 12>::Zero();
      for (const Terms& one : all_combinations()) {
        if (count(one) != 1 || !terms.includes(one)) continue;
        if (one.pressure && !averages_green_strain(terms.solid)) continue;  // it averages another strain
        W += law_energy_density(law_at(one, H), H);
        P += law_stress(law_at(one, H), H);
        K += law_stiffness(law_at(one, H), H, alpha);
      }
      const Law<double> law = law_at(terms, H);
      if (terms.pressure && !averages_green_strain(terms.solid)) {
        W += law.pressure * volume_change(H) / 2;
        P += law.pressure * deformation_cofactor(H);
        K += volume_stiffness(law.pressure, H, alpha);
      }
      CHECK(std::abs(law_energy_density(law, H) - W) <= 1e-13 * std::abs(W));
      CHECK((law_stress(law, H) - P).norm() <= 1e-13 * P.norm());
      CHECK((law_stiffness(law, H, alpha) - K).norm() <= 1e-13 * K.norm());
    }
}

TEST_CASE("each term is the one of its own file") {
  const double p = 5e3;
  const Mat3<double> H = states()[1];
  const auto single = [&](const Terms& terms) {
    Law<double> law = law_at(terms, H);
    law.pressure = p;
    return law;
  };
  const Law<double> svk = single({}), volume = single({.solid = MaterialLaw::none, .volume = true}),
                    pressure = single({.solid = MaterialLaw::none, .pressure = true}),
                    guard = single({.solid = MaterialLaw::none, .guard = true}),
                    fibre = single({.solid = MaterialLaw::none, .fibre = true}),
                    neo = single({.solid = MaterialLaw::neo_hookean}),
                    yeoh = single({.solid = MaterialLaw::yeoh});
  CHECK(law_energy_density(svk, H) == svk_energy_density(H, 1e4, 1.5e4));
  CHECK(law_energy_density(volume, H) == volume_energy_density(H, 2e5));
  CHECK(law_energy_density(pressure, H) == pressure_energy_density(H, p, MaterialLaw::svk));
  CHECK(law_energy_density(guard, H) == guard_energy_density(H, 4e4, 0.8));
  CHECK(law_energy_density(guard, H) > 0);
  CHECK(law_stress(svk, H) == svk_stress(H, 1e4, 1.5e4));
  CHECK(law_stress(volume, H) == volume_stress(H, 2e5));
  CHECK(law_stress(pressure, H) == pressure_stress(H, p, MaterialLaw::svk));
  CHECK(law_stress(guard, H) == guard_stress(H, 4e4, 0.8));
  CHECK(law_energy_density(fibre, H) == fibre_energy_density<double>(H, fibre_moduli, fibre_direction()));
  CHECK(law_energy_density(neo, H) == neo_hookean_energy_density(H, 1e4, 1.5e4));
  CHECK(law_stress(neo, H) == neo_hookean_stress(H, 1e4, 1.5e4));
  CHECK(law_energy_density(yeoh, H) == Yeoh::energy_density(H, yeoh));
  CHECK(law_stress(yeoh, H) == Yeoh::stress(H, yeoh));
}

TEST_CASE("rotations change no energy, and turn stress and stiffness, whatever the terms") {
  const Mat3<double> I = Mat3<double>::Identity(),
                     Q = Eigen::AngleAxisd(2.1, Vec3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const Mat34<double> alpha = gradients();
  Eigen::Matrix<double, 12, 12> turn = Eigen::Matrix<double, 12, 12>::Zero();
  for (int c = 0; c < 4; ++c) turn.block<3, 3>(3 * c, 3 * c) = Q;
  for (const Terms& terms : all_combinations())
    for (const Mat3<double>& H : states()) {
      CAPTURE(name(terms));
      const Mat3<double> turned = Q * (I + H) - I, P = law_stress(law_at(terms, H), H);
      const Eigen::Matrix<double, 12, 12> K = law_stiffness(law_at(terms, H), H, alpha);
      const double W = law_energy_density(law_at(terms, H), H);
      CHECK(std::abs(law_energy_density(law_at(terms, turned), turned) - W) <= 1e-12 * std::abs(W));
      CHECK((law_stress(law_at(terms, turned), turned) - Q * P).norm() <= 1e-12 * P.norm());
      CHECK((law_stiffness(law_at(terms, turned), turned, alpha) - turn * K * turn.transpose()).norm() <=
            1e-12 * K.norm());
    }
}

TEST_CASE("moduli times a volume give that volume's energy and stress") {
  const Mat3<double> H = states()[1];
  const Law<double> law = law_at({MaterialLaw::svk, true, true, true, true}, H);
  CHECK(law_energy_density(law.times(0.3), H) == near(0.3 * law_energy_density(law, H), 1e-14));
  CHECK((law_stress(law.times(0.3), H) - 0.3 * law_stress(law, H)).norm() <
        1e-14 * law_stress(law, H).norm());
}

// Packs and numbers add components up in different orders.
TEST_CASE("a register's lanes follow the law of each alone") {
  using Lane = Pack<double>;
  const Vec3d alpha = gradients().col(1);
  Vec3<Lane> alphas;
  for (int i = 0; i < 3; ++i) alphas[i] = alpha[i];
  for (const Terms& terms : all_combinations())
    for (std::size_t start = 0; start < states().size(); ++start) {
      const Law<double> law = law_at(terms, states()[0]);
      if (terms.solid == MaterialLaw::none) continue;
      const auto state_of = [&](int lane) { return states()[(start + std::size_t(lane)) % states().size()]; };
      Mat3<Lane> H;
      for (int i = 0; i < 9; ++i) H(i) = Lane([&](int lane) { return state_of(lane)(i); });
      const Lane W = law_energy_density(law.as<Lane>(), H);
      const Mat3<Lane> P = law_stress(law.as<Lane>(), H), K = law_diagonal_block(law.as<Lane>(), H, alphas);
      for (int lane = 0; lane < int(Lane::size()); ++lane) {
        const Mat3<double> alone = law_stress(law, state_of(lane)),
                           block = law_diagonal_block(law, state_of(lane), alpha);
        Mat3<double> own, own_block;
        for (int i = 0; i < 9; ++i) own(i) = P(i)[lane];
        for (int i = 0; i < 9; ++i) own_block(i) = K(i)[lane];
        CHECK(double(W[lane]) == near(law_energy_density(law, state_of(lane)), 1e-14));
        CHECK((own - alone).norm() < 1e-14 * alone.norm());
        CHECK((own_block - block).norm() < 1e-14 * block.norm());
      }
    }
}

TEST_CASE("at rest a law has the stiffness of its linear model, whatever its other terms") {
  const Mat3<double> rest = Mat3<double>::Zero();
  Mat34<double> alpha;
  alpha << 3, -1, 0.5, -2.5, 0.2, 4, -1, -3.2, 1, 0.7, 2, -3.7;
  for (const Terms& terms : all_combinations()) {
    if (terms.solid == MaterialLaw::none) continue;
    CAPTURE(name(terms));
    const Law<double> law = law_at(terms, rest);
    const auto K = law_stiffness(law, rest, alpha);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        const Mat3<double> difference =
            linear_block<double>(law, alpha.col(j), alpha.col(k)) - K.template block<3, 3>(3 * j, 3 * k);
        CHECK(difference.norm() < 1e-14 * K.norm());
      }
  }
}
