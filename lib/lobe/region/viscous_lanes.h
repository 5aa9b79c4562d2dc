// The branches of as many tetrahedra or domains of a block as one register holds.
#pragma once

#include "lobe/fem/viscous_law.h"
#include "lobe/numerics/simd.h"
#include "lobe/region/viscous_kernels.h"

namespace lobe {

template <class T>
using SixStrains = std::array<T, 6>;  // xx, yy, zz, xy, xz, yz

template <class T>
[[gnu::always_inline]] inline SixStrains<T> six_of(const Mat3<T>& E) {
  return {E(0, 0), E(1, 1), E(2, 2), E(0, 1), E(0, 2), E(1, 2)};
}
template <class T>
[[gnu::always_inline]] inline Mat3<T> matrix_of(const SixStrains<T>& s) {
  Mat3<T> S;
  S(0, 0) = s[0];
  S(1, 1) = s[1];
  S(2, 2) = s[2];
  S(0, 1) = S(1, 0) = s[3];
  S(0, 2) = S(2, 0) = s[4];
  S(1, 2) = S(2, 1) = s[5];
  return S;
}

// Adds C:D.
template <class T, class Real>
[[gnu::always_inline]] inline void add_branch(SixStrains<T>& S, const SixStrains<T>& D, const Real& lambda,
                                              const Real& two_mu) {
  const T pressure = (D[0] + D[1] + D[2]) * T(lambda);
  for (int k = 0; k < 6; ++k) {
    S[k] += D[k] * T(two_mu);
    if (k < 3) S[k] += pressure;
  }
}

// Σ C_i:(E − A_i(t)) [Pa]. Brings A_i to the later time, if asked.
template <class T, class Real = typename T::value_type>
[[gnu::always_inline]] inline Mat3<T> branch_stress(const ViscousArrays<Real>& viscous, Index block,
                                                    int first, const Mat3<T>& E) {
  const SixStrains<T> e = six_of(E);
  SixStrains<T> S;
  S.fill(T(0));
  DashpotStrains<Real>* strains = viscous.strains + block * viscous.terms;
  for (int i = 0; i < viscous.terms; ++i) {
    const Branch<Real>& branch = viscous.branches[i];
    SixStrains<T> D;
    for (int k = 0; k < 6; ++k) D[k] = e[k] - T(&strains[i].A[k][first]);
    add_branch(S, D, branch.lambda * branch.before, branch.two_mu * branch.before);
    if (!viscous.follows) continue;
    for (int k = 0; k < 6; ++k) (e[k] - D[k] * T(branch.over)).copy_to(&strains[i].A[k][first]);
  }
  return matrix_of(S);
}

// Σ ½ (E − A_i(t)):C_i:(E − A_i(t)) [J/m³].
template <class T, class Real = typename T::value_type>
[[gnu::always_inline]] inline T branch_energy(const ViscousArrays<Real>& viscous, Index block, int first,
                                              const Mat3<T>& E) {
  const SixStrains<T> e = six_of(E);
  const DashpotStrains<Real>* strains = viscous.strains + block * viscous.terms;
  T W = T(0);
  for (int i = 0; i < viscous.terms; ++i) {
    const Branch<Real>& branch = viscous.branches[i];
    SixStrains<T> D, S;
    S.fill(T(0));
    for (int k = 0; k < 6; ++k) D[k] = (e[k] - T(&strains[i].A[k][first])) * T(branch.before);
    add_branch(S, D, branch.lambda, branch.two_mu);
    for (int k = 0; k < 6; ++k) W += S[k] * D[k] * T(Real(k < 3 ? 0.5f : 1));
  }
  return W;
}

// The moduli of all branches [Pa], and Q = Σ C_i:A_i.
template <class T>
struct BranchesAtOnce {
  using Real = typename T::value_type;
  Real lambda{}, mu{};
  Mat3<T> Q;

  [[gnu::always_inline]] BranchesAtOnce(const ViscousArrays<Real>& viscous, Index block, int first) {
    SixStrains<T> sum;
    sum.fill(T(0));
    const DashpotStrains<Real>* strains = viscous.strains + block * viscous.terms;
    for (int i = 0; i < viscous.terms; ++i) {
      const Branch<Real>& branch = viscous.branches[i];
      SixStrains<T> A;
      for (int k = 0; k < 6; ++k) A[k].copy_from(&strains[i].A[k][first]);
      add_branch(sum, A, branch.lambda, branch.two_mu);
      lambda += branch.lambda;
      mu += branch.two_mu * Real(0.5f);
    }
    Q = matrix_of(sum);
  }
  [[gnu::always_inline]] Mat3<T> diagonal_block(const Mat3<T>& H, const Vec3<T>& alpha) const {
    return branches_diagonal_block(H, alpha, T(lambda), T(mu), Q);
  }
};

}  // namespace lobe
