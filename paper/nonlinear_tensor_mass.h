// The coefficients of the non-linear tensor-mass model, [PDA] eq. (3), (6), (7) and table 1.
//
// The SVK energy of one tetrahedron is a polynomial in the displacements of its vertices,
//   W      = V (½ Σ u_jᵀ B_jk u_k + Σ (u_j·C_jkl)(u_k·u_l) + Σ D_jklm (u_j·u_k)(u_l·u_m))
//   B_jk   = λ α_j⊗α_k + μ (α_k⊗α_j + (α_j·α_k) I)
//   C_jkl  = λ/2 α_j (α_k·α_l) + μ/2 (α_l (α_j·α_k) + α_k (α_j·α_l))
//   D_jklm = λ/8 (α_j·α_k)(α_l·α_m) + μ/4 (α_j·α_m)(α_k·α_l)
// (the print lacks the ½ and the volume: erratum 1).
// Its terms are sorted by the set of vertices they touch: a vertex, an edge, a triangle, the tetrahedron. The
// coefficients of a shared vertex, edge or triangle add up over its tetrahedra, so that each is evaluated
// once. D enters only through its part that is symmetric in j↔k, l↔m and (jk)↔(lm),
//   D_jk,lm = λ/8 (jk)(lm) + μ/8 ((jl)(km) + (jm)(kl)),  (jk) = α_j·α_k.
// The terms of a fibre, quadratic in Green's strain like the others, add to each (theory, section 4): with
// their stress σ(E) of fibre_term.h and E_jk = sym(α_j⊗α_k),
//   B_jk of fibre_block(),  C_jkl += ½ σ(E_kl) α_j,  D_jk,lm += ⅛ σ(E_jk):E_lm.
#pragma once

#include <array>

#include "lobe/fem/law_moduli.h"
#include "lobe/fem/shape.h"
#include "lobe/types.h"

namespace lobe {

// The members of each struct are sums over tetrahedra of V × coefficient × the number of equal terms.
// `values` has them in the order in which the comment names them.

struct VertexTerms {  // ½ uᵀ B u + (u·C)(u·u) + D (u·u)²
  static constexpr int vertices = 1, size = 9 + 3 + 1;
  std::array<double, size> values{};  // B (column-major), C, D
};

// uᵢᵀ B uⱼ + (uᵢ·C1)(uᵢ·uⱼ) + (uⱼ·C2)(uᵢ·uᵢ) + (uⱼ·C3)(uᵢ·uⱼ) + (uᵢ·C4)(uⱼ·uⱼ)
// + D1 (uᵢ·uᵢ)(uⱼ·uⱼ) + D2 (uᵢ·uⱼ)² + D3 (uᵢ·uᵢ)(uᵢ·uⱼ) + D4 (uⱼ·uⱼ)(uᵢ·uⱼ)
struct EdgeTerms {
  static constexpr int vertices = 2, size = 9 + 12 + 4;
  std::array<double, size> values{};  // B, C1 … C4, D1 … D4
};

// (uᵢ·C1)(uⱼ·uₖ) + (uⱼ·C2)(uᵢ·uₖ) + (uₖ·C3)(uᵢ·uⱼ)
// + D1 (uᵢ·uᵢ)(uⱼ·uₖ) + D2 (uⱼ·uⱼ)(uᵢ·uₖ) + D3 (uₖ·uₖ)(uᵢ·uⱼ)
// + D4 (uᵢ·uⱼ)(uᵢ·uₖ) + D5 (uⱼ·uᵢ)(uⱼ·uₖ) + D6 (uₖ·uᵢ)(uₖ·uⱼ)
struct TriangleTerms {
  static constexpr int vertices = 3, size = 9 + 6;
  std::array<double, size> values{};  // C1 … C3, D1 … D6
};

// D1 (uᵢ·uⱼ)(uₖ·uₗ) + D2 (uᵢ·uₖ)(uⱼ·uₗ) + D3 (uᵢ·uₗ)(uⱼ·uₖ)
struct TetTerms {
  static constexpr int vertices = 4, size = 3;
  std::array<double, size> values{};  // D1 … D3
};

// What one tetrahedron contributes to the terms of its corners i, j, k. The evaluation must get their
// displacements in the same order. Of the law they take λ, μ and the fibre.
VertexTerms vertex_terms(const Shape& s, const Law<double>& law, int i);
EdgeTerms edge_terms(const Shape& s, const Law<double>& law, int i, int j);
TriangleTerms triangle_terms(const Shape& s, const Law<double>& law, int i, int j, int k);
TetTerms tet_terms(const Shape& s, const Law<double>& law, int i, int j, int k, int l);

// Forces [N] (minus the gradient) of the terms of one vertex, edge, triangle or tetrahedron.
// `c`: values in the order above; u [m]; forces are written, not added.
template <class T>
Vec3<T> vertex_force(const T* c, const Vec3<T>& u) {
  const Eigen::Map<const Mat3<T>> B(c);
  const Eigen::Map<const Vec3<T>> C(c + 9);
  const T uu = u.dot(u);
  return -(B * u) - C * uu - u * (T(2) * C.dot(u) + T(4) * c[12] * uu);
}

template <class T>
void edge_forces(const T* c, const Vec3<T>& ui, const Vec3<T>& uj, Vec3<T>& fi, Vec3<T>& fj) {
  const Eigen::Map<const Mat3<T>> B(c);
  const Eigen::Map<const Eigen::Matrix<T, 3, 4>> C(c + 9);
  const T* D = c + 21;
  const T ii = ui.dot(ui), jj = uj.dot(uj), ij = ui.dot(uj);
  // ∂W/∂(uᵢ·uᵢ), ∂W/∂(uⱼ·uⱼ), ∂W/∂(uᵢ·uⱼ) at fixed linear factors
  const T w_ii = C.col(1).dot(uj) + D[0] * jj + D[2] * ij;
  const T w_jj = C.col(3).dot(ui) + D[0] * ii + D[3] * ij;
  const T w_ij = C.col(0).dot(ui) + C.col(2).dot(uj) + T(2) * D[1] * ij + D[2] * ii + D[3] * jj;
  fi = -(B * uj + C.col(0) * ij + C.col(3) * jj + ui * (T(2) * w_ii) + uj * w_ij);
  fj = -(B.transpose() * ui + C.col(1) * ii + C.col(2) * ij + uj * (T(2) * w_jj) + ui * w_ij);
}

template <class T>
void triangle_forces(const T* c, const Vec3<T>& ui, const Vec3<T>& uj, const Vec3<T>& uk, Vec3<T>& fi,
                     Vec3<T>& fj, Vec3<T>& fk) {
  const Eigen::Map<const Mat3<T>> C(c);
  const T* D = c + 9;
  const T ii = ui.dot(ui), jj = uj.dot(uj), kk = uk.dot(uk), ij = ui.dot(uj), ik = ui.dot(uk),
          jk = uj.dot(uk);
  const T w_ii = D[0] * jk, w_jj = D[1] * ik, w_kk = D[2] * ij;
  const T w_jk = C.col(0).dot(ui) + D[0] * ii + D[4] * ij + D[5] * ik;
  const T w_ik = C.col(1).dot(uj) + D[1] * jj + D[3] * ij + D[5] * jk;
  const T w_ij = C.col(2).dot(uk) + D[2] * kk + D[3] * ik + D[4] * jk;
  fi = -(C.col(0) * jk + ui * (T(2) * w_ii) + uk * w_ik + uj * w_ij);
  fj = -(C.col(1) * ik + uj * (T(2) * w_jj) + uk * w_jk + ui * w_ij);
  fk = -(C.col(2) * ij + uk * (T(2) * w_kk) + uj * w_jk + ui * w_ik);
}

template <class T>
void tet_term_forces(const T* D, const Vec3<T>& u0, const Vec3<T>& u1, const Vec3<T>& u2, const Vec3<T>& u3,
                     Vec3<T>& f0, Vec3<T>& f1, Vec3<T>& f2, Vec3<T>& f3) {
  const T w01 = D[0] * u2.dot(u3), w23 = D[0] * u0.dot(u1);
  const T w02 = D[1] * u1.dot(u3), w13 = D[1] * u0.dot(u2);
  const T w03 = D[2] * u1.dot(u2), w12 = D[2] * u0.dot(u3);
  f0 = -(u1 * w01 + u2 * w02 + u3 * w03);
  f1 = -(u0 * w01 + u3 * w13 + u2 * w12);
  f2 = -(u3 * w23 + u0 * w02 + u1 * w12);
  f3 = -(u2 * w23 + u1 * w13 + u0 * w03);
}

}  // namespace lobe
