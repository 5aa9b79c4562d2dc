// Stresses in closed form of one deformation each: uniaxial stretch and simple shear, with fibres and
// neo-Hookean, from strains of a millionth to far beyond the linear. Expected values are written so that
// nothing cancels in them.
#include <doctest/doctest.h>

#include <cmath>
#include <iterator>

#include "fem/moduli.h"
#include "lobe/fem/elements.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/fem/transverse_isotropy.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr TransverseConstants c{9e4, 3e4, 0.4, 0.35, 2e4};
constexpr double elongations[] = {-0.4, -1e-3, -1e-6, 1e-6, 1e-3, 0.3, 0.6};
constexpr double shears[] = {1e-6, 1e-3, 0.4, 1.5};

double root_less_one(double x) { return x / (1 + std::sqrt(1 + x)); }  // √(1 + x) − 1

Law<double> fibrous_law(const Vec3d& a) {
  Elastic elastic;
  set_transverse(c, elastic);
  Law<double> law = nonlinear_law(elastic, 0, 0);
  law.direction = a;
  return law;
}

Law<double> linear_fibrous_law(const Vec3d& a) {
  Elastic elastic;
  set_transverse(c, elastic);
  Law<double> law = linear_law(elastic);
  law.direction = a;
  return law;
}

Law<double> neo_hookean_law() { return nonlinear_law({lambda, mu, 1000, 0, MaterialLaw::neo_hookean}, 0, 0); }

double distance(const Mat3<double>& P, const Mat3<double>& expected) {  // relative
  return (P - expected).norm() / expected.norm();
}

// Normal stiffness C_ij of axes i, j, for a fibre along axis L: (2.11) of the theory.
double normal_stiffness(int i, int j, int L) {
  const double nu_TL = c.poisson_along * c.young_across / c.young_along,
               delta = 1 - c.poisson_across - 2 * c.poisson_along * nu_TL;
  if (i == L && j == L) return c.young_along * (1 - c.poisson_across) / delta;
  if (i == L || j == L) return c.young_across * c.poisson_along / delta;
  const double sum = c.young_across / delta, difference = c.young_across / (1 + c.poisson_across);
  return i == j ? (sum + difference) / 2 : (sum - difference) / 2;
}

struct AxialPull {
  Vec3d fibre;
  double young, nu_y, nu_z;  // of a pull along x
};
const AxialPull pulls[] = {
    {Vec3d::UnitX(), c.young_along, c.poisson_along, c.poisson_along},
    {Vec3d::UnitZ(), c.young_across, c.poisson_across, c.poisson_along* c.young_across / c.young_along}};

}  // namespace

// E = e + e²/2 along, −ν E across: S = Young's modulus × E along, P = (1 + e) S.
TEST_CASE("a bar with fibres that is stretched along and across has one stress, Young's modulus times E") {
  for (const AxialPull& pull : pulls)
    for (double e : elongations) {
      const double E = e + e * e / 2;
      const Mat3<double> H =
          Vec3d(e, root_less_one(-2 * pull.nu_y * E), root_less_one(-2 * pull.nu_z * E)).asDiagonal();
      const Law<double> law = fibrous_law(pull.fibre);
      const Mat3<double> expected = Vec3d((1 + e) * pull.young * E, 0, 0).asDiagonal();
      CAPTURE(e);
      CHECK(distance(law_stress(law, H), expected) < 1e-12);
      CHECK(law_energy_density(law, H) == near(pull.young * E * E / 2, 1e-12));
      const Mat3<double> strain = Vec3d(e, -pull.nu_y * e, -pull.nu_z * e).asDiagonal(),
                         stress = Vec3d(pull.young * e, 0, 0).asDiagonal();
      CHECK(distance(linear_stress(linear_fibrous_law(pull.fibre), strain), stress) < 1e-12);
    }
}

// F = I + g e_i⊗e_j: E has g/2 at ij and ji, and g²/2 at jj. With G of the plane S has G g at ij and ji, and
// C_kj g²/2 on the diagonal; P = S + g e_i⊗(S e_j).
TEST_CASE("a solid with fibres that is sheared in the three planes has the stress of its moduli") {
  for (int L = 0; L < 3; ++L)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (double g : shears) {
          if (i == j) continue;
          const double G = i == L || j == L ? c.shear_along : c.young_across / (2 * (1 + c.poisson_across));
          Mat3<double> H = Mat3<double>::Zero(), S = H, linear = H;
          H(i, j) = g;
          for (int k = 0; k < 3; ++k) S(k, k) = normal_stiffness(k, j, L) * g * g / 2;
          linear(i, j) = linear(j, i) = S(i, j) = S(j, i) = G * g;
          Mat3<double> expected = S;
          expected.row(i) += g * S.row(j);
          CAPTURE(L);
          CAPTURE(g);
          CHECK(distance(law_stress(fibrous_law(Vec3d::Unit(L)), H), expected) < 1e-12);
          CHECK(distance(linear_stress(linear_fibrous_law(Vec3d::Unit(L)), H), linear) < 1e-12);
        }
}

// Free sides, P₂₂ = 0, ask for (λ + μ) l² m² = (λ + 2μ) l − μ of the stretches l = 1 + e and m; then
// P₁₁ = μ (l² − m²)/l.
TEST_CASE("a neo-Hookean bar with free sides has its closed form") {
  for (double e : elongations) {
    const double l = 1 + e, square = -e * (lambda + (lambda + mu) * e) / ((lambda + mu) * l * l);  // m² − 1
    const double m = root_less_one(square);
    const Mat3<double> H = Vec3d(e, m, m).asDiagonal();
    const Mat3<double> expected = Vec3d(mu * (2 * e + e * e - square) / l, 0, 0).asDiagonal();
    CAPTURE(e);
    CHECK(distance(law_stress(neo_hookean_law(), H), expected) < 1e-12);
  }
}

TEST_CASE("a neo-Hookean solid in uniaxial strain is linear along, however far it is crushed") {
  for (double e : elongations) {
    const Mat3<double> H = Vec3d(e, 0, 0).asDiagonal();
    const double across = e * (lambda + (lambda + mu) * e);
    const Mat3<double> expected = Vec3d((lambda + 2 * mu) * e, across, across).asDiagonal();
    CHECK(distance(law_stress(neo_hookean_law(), H), expected) < 1e-12);
  }
}

TEST_CASE("a neo-Hookean solid in simple shear has the stress of its shear modulus alone, to the bit") {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (double g : shears) {
        if (i == j) continue;
        Mat3<double> H = Mat3<double>::Zero(), expected = H;
        H(i, j) = g;
        expected(i, j) = expected(j, i) = mu * g;
        CHECK(law_stress(neo_hookean_law(), H) == expected);
        CHECK(law_energy_density(neo_hookean_law(), H) == near(mu * g * g / 2, 1e-15));
      }
}
