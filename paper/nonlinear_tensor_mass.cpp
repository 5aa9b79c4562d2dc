#include "paper/nonlinear_tensor_mass.h"

#include "lobe/fem/law.h"

namespace lobe {
namespace {

Mat3<double> strain(const Mat34<double>& alpha, int j, int k) {  // sym(α_j⊗α_k)
  const Mat3<double> product = alpha.col(j) * alpha.col(k).transpose();
  return (product + product.transpose()) / 2;
}

Mat3<double> fibre_stress(const Mat34<double>& alpha, const Law<double>& law, int j, int k) {
  return fibre_stress_of_strain<double>(strain(alpha, j, k), law.fibre, law.direction);
}

// What fibres add. These functions are never inlined, so that bodies without fibres are as fast as without
// these branches.
[[gnu::noinline]] Vec3d fibre_C(const Mat34<double>& alpha, const Law<double>& law, int j, int k, int l) {
  return 0.5 * fibre_stress(alpha, law, k, l) * alpha.col(j);
}
[[gnu::noinline]] double fibre_D(const Mat34<double>& alpha, const Law<double>& law, int j, int k, int l,
                                 int m) {
  return fibre_stress(alpha, law, j, k).cwiseProduct(strain(alpha, l, m)).sum() / 8;
}
[[gnu::noinline]] Mat3<double> block_with_fibres(const Mat34<double>& alpha, const Law<double>& law, int j,
                                                 int k) {
  return linear_block<double>(law, alpha.col(j), alpha.col(k));
}

// The coefficients of one tetrahedron without V, as in the header.
struct Coefficients {
  const Mat34<double>& alpha;
  const Law<double>& law;
  double lambda, mu;

  double dot(int j, int k) const { return alpha.col(j).dot(alpha.col(k)); }

  Mat3<double> B(int j, int k) const {
    if (law.terms.fibre) return block_with_fibres(alpha, law, j, k);
    return hooke_block<double>(alpha.col(j), alpha.col(k), lambda, mu);
  }

  Vec3d C(int j, int k, int l) const {
    const Vec3d C = 0.5 * lambda * dot(k, l) * alpha.col(j) +
                    0.5 * mu * (dot(j, k) * alpha.col(l) + dot(j, l) * alpha.col(k));
    if (!law.terms.fibre) return C;
    return C + fibre_C(alpha, law, j, k, l);
  }

  double D(int j, int k, int l, int m) const {
    const double D =
        lambda / 8 * dot(j, k) * dot(l, m) + mu / 8 * (dot(j, l) * dot(k, m) + dot(j, m) * dot(k, l));
    if (!law.terms.fibre) return D;
    return D + fibre_D(alpha, law, j, k, l, m);
  }
};

}  // namespace

VertexTerms vertex_terms(const Shape& s, const Law<double>& law, int i) {
  const Coefficients c{s.gradients, law, law.lambda, law.mu};
  VertexTerms terms;
  double* v = terms.values.data();
  Eigen::Map<Mat3<double>>{v} = s.volume * c.B(i, i);
  Eigen::Map<Vec3d>{v + 9} = s.volume * c.C(i, i, i);
  v[12] = s.volume * c.D(i, i, i, i);
  return terms;
}

EdgeTerms edge_terms(const Shape& s, const Law<double>& law, int i, int j) {
  const Coefficients c{s.gradients, law, law.lambda, law.mu};
  EdgeTerms terms;
  double* v = terms.values.data();
  Eigen::Map<Mat3<double>>{v} = s.volume * c.B(i, j);
  Eigen::Map<Vec3d>{v + 9} = s.volume * 2 * c.C(i, i, j);
  Eigen::Map<Vec3d>{v + 12} = s.volume * c.C(j, i, i);
  Eigen::Map<Vec3d>{v + 15} = s.volume * 2 * c.C(j, j, i);
  Eigen::Map<Vec3d>{v + 18} = s.volume * c.C(i, j, j);
  v[21] = s.volume * 2 * c.D(i, i, j, j);
  v[22] = s.volume * 4 * c.D(i, j, i, j);
  v[23] = s.volume * 4 * c.D(i, i, i, j);
  v[24] = s.volume * 4 * c.D(j, j, i, j);
  return terms;
}

TriangleTerms triangle_terms(const Shape& s, const Law<double>& law, int i, int j, int k) {
  const Coefficients c{s.gradients, law, law.lambda, law.mu};
  TriangleTerms terms;
  double* v = terms.values.data();
  Eigen::Map<Vec3d>{v} = s.volume * 2 * c.C(i, j, k);
  Eigen::Map<Vec3d>{v + 3} = s.volume * 2 * c.C(j, i, k);
  Eigen::Map<Vec3d>{v + 6} = s.volume * 2 * c.C(k, i, j);
  v[9] = s.volume * 4 * c.D(i, i, j, k);
  v[10] = s.volume * 4 * c.D(j, j, i, k);
  v[11] = s.volume * 4 * c.D(k, k, i, j);
  v[12] = s.volume * 8 * c.D(i, j, i, k);
  v[13] = s.volume * 8 * c.D(j, i, j, k);
  v[14] = s.volume * 8 * c.D(k, i, k, j);
  return terms;
}

TetTerms tet_terms(const Shape& s, const Law<double>& law, int i, int j, int k, int l) {
  const Coefficients c{s.gradients, law, law.lambda, law.mu};
  return {{s.volume * 8 * c.D(i, j, k, l), s.volume * 8 * c.D(i, k, j, l), s.volume * 8 * c.D(i, l, j, k)}};
}

}  // namespace lobe
