#include "benchmarks/reduced/cell_kernel.h"

#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define LOBE_CELL_CLONES [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#else
#define LOBE_CELL_CLONES
#endif
#pragma GCC diagnostic ignored "-Wpsabi"  // no vector crosses a call: all is inlined

namespace lobe::reduced {
namespace {

template <class Real>
using Wide [[gnu::vector_size(64)]] = Real;
template <class Real>
using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;

#define LOBE_INLINE [[gnu::always_inline]] inline

template <class Real>
LOBE_INLINE void load(Wide<Real>& to, const Real* from) {
  std::memcpy(&to, from, sizeof to);
}

// x, y, z of the nodes of all lanes.
template <class Real>
LOBE_INLINE void gather(const Real* q, const Index* nodes, Wide<Real>* xyz) {
  constexpr int width = CellBlock<Real>::width;
  alignas(64) Real rows[3][width];
  for (int lane = 0; lane < width; ++lane)
    for (int d = 0; d < 3; ++d) rows[d][lane] = q[4 * std::size_t(nodes[lane]) + std::size_t(d)];
  for (int d = 0; d < 3; ++d) load<Real>(xyz[d], rows[d]);
}

template <class Real>
LOBE_INLINE void scatter(const Wide<Real>* xyz, const Index* nodes, Real* f) {
  constexpr int width = CellBlock<Real>::width;
  alignas(64) Real rows[3][width];
  for (int d = 0; d < 3; ++d) std::memcpy(rows[d], &xyz[d], 64);
  for (int lane = 0; lane < width; ++lane)
    for (int d = 0; d < 3; ++d) f[4 * std::size_t(nodes[lane]) + std::size_t(d)] += rows[d][lane];
}

// Sums of eight with the signs of the functions of lattice.h: from nodes to amplitudes (times 8), and back.
template <class Real>
LOBE_INLINE void transform(Wide<Real>* a) {
  for (int step = 1; step < 8; step *= 2)
    for (int i = 0; i < 8; ++i)
      if (!(i & step)) {
        const Wide<Real> low = a[i], high = a[i + step];
        a[i] = low + high;
        a[i + step] = high - low;
      }
}
// Where transform() puts the functions 1, ξ, η, ζ, ηζ, ζξ, ξη, ξηζ.
constexpr int place[8] = {0, 1, 2, 4, 6, 5, 3, 7};

// V P of F: SVK and the volume term.
template <class Real>
LOBE_INLINE void stress(const Wide<Real> (&H)[3][3], const Wide<Real> (&F)[3][3], const Wide<Real>& V,
                        Real lambda, Real mu, Real kappa, Wide<Real> (&P)[3][3]) {
  Wide<Real> E[3][3], C[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      E[i][j] = Real(0.5) * (H[i][j] + H[j][i] + H[0][i] * H[0][j] + H[1][i] * H[1][j] + H[2][i] * H[2][j]);
      E[j][i] = E[i][j];
    }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      C[i][j] = F[a][c] * F[b][d] - F[a][d] * F[b][c];
    }
  const Wide<Real> trace = lambda * (E[0][0] + E[1][1] + E[2][2]);
  const Wide<Real> v = F[0][0] * C[0][0] + F[0][1] * C[0][1] + F[0][2] * C[0][2] - Real(1);
  const Wide<Real> p = kappa * v * (v < Real(0) ? -v : v);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      P[i][j] = V * (F[i][j] * trace + 2 * mu * (F[i][0] * E[0][j] + F[i][1] * E[1][j] + F[i][2] * E[2][j]) +
                     p * C[i][j]);
}

template <class Real>
LOBE_INLINE void add_block(const CellBlock<Real>& block, const CellLaw& law, const Real* q, Real* f) {
  using W = Wide<Real>;
  const Real slope = Real(law.slope);
  W a[3][8];
  for (int n = 0; n < 8; ++n) {
    W xyz[3];
    gather<Real>(q, block.nodes[std::size_t(n)].data(), xyz);
    for (int d = 0; d < 3; ++d) a[d][n] = xyz[d] * Real(0.125);
  }
  for (int d = 0; d < 3; ++d) transform<Real>(a[d]);
  W G[4][3], V;
  load<Real>(V, block.V.data());
  for (int k = 0; k < 4; ++k)
    for (int e = 0; e < 3; ++e) load<Real>(G[k][e], block.mean[std::size_t(3 * k + e)].data());
  W H[3][3], F[3][3], P[3][3];  // H = F − I
  for (int d = 0; d < 3; ++d)
    for (int e = 0; e < 3; ++e) {
      H[d][e] = slope * a[d][place[1 + e]];
      for (int k = 0; k < 4; ++k) H[d][e] += a[d][place[4 + k]] * G[k][e];
      F[d][e] = d == e ? H[d][e] + Real(1) : H[d][e];
    }
  stress<Real>(H, F, V, Real(law.lambda), Real(law.mu), Real(law.kappa), P);
  W h[12], t[12];
  for (int k = 0; k < 4; ++k)
    for (int e = 0; e < 3; ++e) {
      h[3 * k + e] =
          F[0][e] * a[0][place[4 + k]] + F[1][e] * a[1][place[4 + k]] + F[2][e] * a[2][place[4 + k]];
      t[3 * k + e] = W{};
    }
  for (int i = 0, entry = 0; i < 12; ++i)
    for (int j = i; j < 12; ++j, ++entry) {
      W K;
      load<Real>(K, block.K[std::size_t(entry)].data());
      t[i] += K * h[j];
      if (i != j) t[j] += K * h[i];
    }
  W g[3][8];
  for (int d = 0; d < 3; ++d) {
    for (int e = 0; e < 3; ++e)
      for (int k = 0; k < 4; ++k) P[d][e] += a[d][place[4 + k]] * t[3 * k + e];
    g[d][0] = W{};
    for (int e = 0; e < 3; ++e) g[d][place[1 + e]] = slope * P[d][e];
    for (int k = 0; k < 4; ++k)
      g[d][place[4 + k]] = P[d][0] * G[k][0] + P[d][1] * G[k][1] + P[d][2] * G[k][2] + F[d][0] * t[3 * k] +
                           F[d][1] * t[3 * k + 1] + F[d][2] * t[3 * k + 2];
  }
  // The transposed sums: signs of ξ, η, ζ and ξηζ turn where a node's bit is 0.
  for (int d = 0; d < 3; ++d) {
    for (int step = 1; step < 8; step *= 2)
      for (int i = 0; i < 8; ++i)
        if (!(i & step)) {
          const W low = g[d][i], high = g[d][i + step];
          g[d][i] = low - high;
          g[d][i + step] = low + high;
        }
  }
  for (int n = 0; n < 8; ++n) {
    W xyz[3];
    for (int d = 0; d < 3; ++d) xyz[d] = g[d][n] * Real(-0.125);
    scatter<Real>(xyz, block.nodes[std::size_t(n)].data(), f);
  }
}

}  // namespace

LOBE_CELL_CLONES
void add_cell_forces(const std::vector<CellBlock<float>>& blocks, const CellLaw& law, const float* q,
                     float* f) {
  for (const auto& block : blocks) add_block<float>(block, law, q, f);
}
LOBE_CELL_CLONES
void add_cell_forces(const std::vector<CellBlock<double>>& blocks, const CellLaw& law, const double* q,
                     double* f) {
  for (const auto& block : blocks) add_block<double>(block, law, q, f);
}

}  // namespace lobe::reduced
