#include "paper/nonlinear_tensor_mass.h"

#include <doctest/doctest.h>

#include "fem/moduli.h"
#include "lobe/fem/elements.h"
#include "lobe/fem/hooke.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/fem/svk.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

const Law<double> isotropic = linear_law(Elastic{lambda, mu});

Mat34<double> rest() {
  Mat34<double> X;
  X << 0, 1, 0, 0.2, 0, 0.1, 1, 0, 0, 0, 0.3, 1.5;
  return X;
}

Mat34<double> displaced() {
  Mat34<double> u;
  u << 0.1, 0.2, -0.1, 0.3, 0, 0.4, 0.1, 0.2, -0.3, 0.2, 0.1, 0;
  return u;
}

double closed_form(const Shape& s, const Mat34<double>& u) {
  return s.volume *
         svk_energy_density(displacement_gradient<double>(u, s.gradients.rightCols<3>()), lambda, mu);
}

// [PDA] eq. (3) and (6) term by term, with the sums over all corners.
double polynomial(const Shape& s, const Mat34<double>& u, double factor_of_B, double sign_of_alpha) {
  const Mat34<double> a = sign_of_alpha * s.gradients;
  const auto dot = [&](int j, int k) { return a.col(j).dot(a.col(k)); };
  const auto uu = [&](int j, int k) { return u.col(j).dot(u.col(k)); };
  double W = 0;
  for (int j = 0; j < 4; ++j)
    for (int k = 0; k < 4; ++k) {
      W += factor_of_B * u.col(j).dot(hooke_block<double>(a.col(j), a.col(k), lambda, mu) * u.col(k));
      for (int l = 0; l < 4; ++l) {
        const Vec3d C =
            lambda / 2 * dot(k, l) * a.col(j) + mu / 2 * (dot(j, k) * a.col(l) + dot(j, l) * a.col(k));
        W += u.col(j).dot(C) * uu(k, l);
        for (int m = 0; m < 4; ++m)
          W += (lambda / 8 * dot(j, k) * dot(l, m) + mu / 4 * dot(j, m) * dot(k, l)) * uu(j, k) * uu(l, m);
      }
    }
  return s.volume * W;
}

// Forces of one tetrahedron from its stored terms.
Mat34<double> stored_forces(const Shape& s, const Mat34<double>& u, const Law<double>& law = isotropic) {
  Mat34<double> f = Mat34<double>::Zero();
  const auto at = [&](int i) -> Vec3d { return u.col(i); };
  for (int i = 0; i < 4; ++i) {
    const VertexTerms terms = vertex_terms(s, law, i);
    f.col(i) += vertex_force(terms.values.data(), at(i));
    for (int j = i + 1; j < 4; ++j) {
      const EdgeTerms edge = edge_terms(s, law, i, j);
      Vec3d fi, fj, fk;
      edge_forces(edge.values.data(), at(i), at(j), fi, fj);
      f.col(i) += fi;
      f.col(j) += fj;
      for (int k = j + 1; k < 4; ++k) {
        const TriangleTerms triangle = triangle_terms(s, law, i, j, k);
        triangle_forces(triangle.values.data(), at(i), at(j), at(k), fi, fj, fk);
        f.col(i) += fi;
        f.col(j) += fj;
        f.col(k) += fk;
      }
    }
  }
  const TetTerms tet = tet_terms(s, law, 0, 1, 2, 3);
  Vec3d f0, f1, f2, f3;
  tet_term_forces(tet.values.data(), at(0), at(1), at(2), at(3), f0, f1, f2, f3);
  f.col(0) += f0;
  f.col(1) += f1;
  f.col(2) += f2;
  f.col(3) += f3;
  return f;
}

}  // namespace

TEST_CASE("erratum 1: the polynomial is the SVK energy only with ½ before B and the volume before all") {
  const Shape s = shape(rest());
  const double exact = closed_form(s, displaced());
  CHECK(polynomial(s, displaced(), 0.5, 1) == near(exact, 1e-12));
  CHECK(std::abs(polynomial(s, displaced(), 1.0, 1) / exact - 1) > 0.05);
  CHECK(std::abs(polynomial(s, displaced(), 0.5, 1) / s.volume / exact - 1) > 0.05);
}

TEST_CASE("erratum 2 matters in the cubic terms: with −α the polynomial is not the SVK energy") {
  const Shape s = shape(rest());
  const double exact = closed_form(s, displaced());
  CHECK(std::abs(polynomial(s, displaced(), 0.5, -1) / exact - 1) > 0.05);
}

TEST_CASE("stored terms give the closed-form force, which is minus the slope of the energy") {
  const Shape s = shape(rest());
  const Mat34<double> u = displaced();
  const Mat3<double> alpha = s.gradients.rightCols<3>();
  const Mat34<double> direct =
      corner_forces<double>(s.volume * svk_stress(displacement_gradient(u, alpha), lambda, mu), alpha);
  CHECK((stored_forces(s, u) - direct).norm() < 1e-13 * direct.norm());
  const double h = 1e-6;
  for (int i = 0; i < 12; ++i) {
    Mat34<double> plus = u, minus = u;
    plus(i) += h;
    minus(i) -= h;
    CHECK(direct(i) == near(-(closed_form(s, plus) - closed_form(s, minus)) / (2 * h), 1e-6));
  }
}

TEST_CASE("the stored terms of a law with a fibre give its closed-form force") {
  const Shape s = shape(rest());
  Law<double> law = isotropic;
  law.terms.fibre = true;
  law.fibre = {3e3, 8e3, 5e4};
  law.direction = Vec3d(2, -1, 0.5).normalized();
  const Mat3<double> alpha = s.gradients.rightCols<3>();
  const Mat34<double> u = displaced(),
                      expected = corner_forces<double>(
                          s.volume * law_stress(law, displacement_gradient(u, alpha)), alpha);
  CHECK((stored_forces(s, u, law) - expected).norm() < 1e-13 * expected.norm());
  CHECK((stored_forces(s, u) - expected).norm() > 0.1 * expected.norm());
}
