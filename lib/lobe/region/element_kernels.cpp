// What ElementBlocks computes: forces, energies and stiffness of one register of tetrahedra at a time.
#include <algorithm>

#include "lobe/fem/pressure_term.h"
#include "lobe/fem/simd.h"
#include "lobe/fem/svk.h"
#include "lobe/fem/volume_term.h"
#include "lobe/region/element_blocks.h"

namespace lobe {
namespace stdx = std::experimental;

template <class Real>
struct ElementBlocks<Real>::Lanes {
  using T = Pack<Real>;
  static constexpr int count = static_cast<int>(T::size());

  Lanes(const Block& block, int first, const Mat3X<Real>& u)
      : lambda_V(&block.lambda_V[first], stdx::element_aligned),
        mu_V(&block.mu_V[first], stdx::element_aligned),
        kappa_V(&block.kappa_V[first], stdx::element_aligned) {
    Mat34<T> at_corners;
    for (int c = 0; c < 4; ++c)
      for (int d = 0; d < 3; ++d)
        at_corners(d, c) =
            T([&](auto lane) { return u.data()[3 * std::size_t(block.corners[c][first + lane]) + d]; });
    for (int i = 0; i < 9; ++i) alpha(i % 3, i / 3).copy_from(&block.alpha[i][first], stdx::element_aligned);
    H = displacement_gradient(at_corners, alpha);
  }

  Vec3<T> gradient(int corner) const {  // α of any of the four corners
    if (corner > 0) return alpha.col(corner - 1);
    return -(alpha.col(0) + alpha.col(1) + alpha.col(2));
  }

  static T pressure_V(const PressureBlock& block, int first, const std::vector<Real>& at_nodes) {  // V p_T
    T sum = 0;
    for (int c = 0; c < 4; ++c) sum += T([&](auto lane) { return at_nodes[block.nodes[c][first + lane]]; });
    return sum * T(&block.V[first], stdx::element_aligned) * Real(0.25f);
  }

  T lambda_V, mu_V, kappa_V;
  Mat3<T> alpha, H;  // α_1, α_2, α_3; ∇u
};

template <class Real>
void ElementBlocks<Real>::evaluate_strains(const Mat3X<Real>& u, Index begin, Index end) {
  for (Index b = begin; b < end; ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(blocks_[b], first, u);
      const Pack<Real> V(&pressure_blocks_[b].V[first], stdx::element_aligned);
      const Pack<Real> volume_strain = V * strain_trace(e.H);
      const Index slot = b * width + first;
      for (int lane = 0; lane < std::min<int>(Lanes::count, tet_count() - slot); ++lane)
        volume_strain_[tet_of_slot_[slot + lane]] = Real(volume_strain[lane]);
    }
}

template <class Real>
void ElementBlocks<Real>::find_pressures(const Mat3X<Real>& u, Parallel& parallel) {
  parallel.for_ranges(Index(blocks_.size()), 2048 / width,
                      [&](Index begin, Index end) { evaluate_strains(u, begin, end); });
  nodes_.gather(volume_strain_, pressure_, parallel);
}

template <class Real>
template <typename ElementBlocks<Real>::Part part, bool nodal_pressure>
void ElementBlocks<Real>::evaluate(const Mat3X<Real>& u, Index begin, Index end) {
  for (Index b = begin; b < end; ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(blocks_[b], first, u);
      Mat3<Pack<Real>> VP;
      if constexpr (part == Part::volume_term)
        VP = volume_stress(e.H, e.kappa_V);
      else
        VP = svk_stress(e.H, e.lambda_V, e.mu_V);
      if constexpr (part == Part::both) VP += volume_stress(e.H, e.kappa_V);
      if constexpr (nodal_pressure)
        VP += pressure_stress(e.H, Lanes::pressure_V(pressure_blocks_[b], first, pressure_));
      const Mat34<Pack<Real>> f = corner_forces(VP, e.alpha);
      Real* place = corner_forces_.data() + std::size_t(b) * 12 * width + first;
      for (int i = 0; i < 12; ++i) f(i % 3, i / 3).copy_to(place + i * width, stdx::element_aligned);
    }
}

template <class Real>
template <typename ElementBlocks<Real>::Part part>
void ElementBlocks<Real>::evaluate_ranges(const Mat3X<Real>& u, Parallel& parallel) {
  parallel.for_ranges(Index(blocks_.size()), 2048 / width, [&](Index begin, Index end) {
    if (part != Part::volume_term && nodal_pressure_)
      evaluate<part, true>(u, begin, end);
    else
      evaluate<part, false>(u, begin, end);
  });
}

template <class Real>
void ElementBlocks<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Part part, Parallel& parallel) {
  if (!volume_term_ && part == Part::volume_term) return;
  if (!volume_term_) part = Part::svk;
  if (nodal_pressure_) find_pressures(u, parallel);
  if (part == Part::svk) evaluate_ranges<Part::svk>(u, parallel);
  if (part == Part::volume_term) evaluate_ranges<Part::volume_term>(u, parallel);
  if (part == Part::both) evaluate_ranges<Part::both>(u, parallel);
  parallel.for_ranges(outputs_of_.vertex_count(), 1024, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v) {
      Vec3<Real> sum = Vec3<Real>::Zero();
      for (Index place : outputs_of_[v])
        for (int d = 0; d < 3; ++d) sum[d] += corner_forces_[std::size_t(place + d * width)];
      f.col(v) += sum;
    }
  });
}

template <class Real>
double ElementBlocks<Real>::energy(const Mat3X<Real>& u) {
  Parallel one_thread;
  if (nodal_pressure_) find_pressures(u, one_thread);
  double sum = 0;
  for (Index b = 0; b < Index(blocks_.size()); ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(blocks_[b], first, u);
      Pack<Real> W = svk_energy_density(e.H, e.lambda_V, e.mu_V);
      if (volume_term_) W += volume_energy_density(e.H, e.kappa_V);
      if (nodal_pressure_)
        W += pressure_energy_density(e.H, Lanes::pressure_V(pressure_blocks_[b], first, pressure_));
      for (int lane = 0; lane < Lanes::count; ++lane) sum += double(Real(W[lane]));
    }
  return sum;
}

// ∂(V tr E)/∂u_c = V F α_c, from the slot of the first of these tetrahedra on.
template <class Real>
void ElementBlocks<Real>::keep_slopes(const Lanes& e, Index begin) {
  const Row& V = pressure_blocks_[begin / width].V;
  for (int c = 0; c < 4; ++c) {
    const Vec3<Pack<Real>> a = e.gradient(c), Fa = a + e.H.lazyProduct(a);
    for (int lane = 0; lane < std::min<int>(Lanes::count, tet_count() - begin); ++lane)
      for (int d = 0; d < 3; ++d)
        slopes_(d, 4 * tet_of_slot_[begin + lane] + c) =
            double(V[begin % width + lane]) * double(Real(Fa[d][lane]));
  }
}

template <class Real>
typename ElementBlocks<Real>::Stiffness ElementBlocks<Real>::add_diagonal_stiffness(const Mat3X<Real>& u,
                                                                                    DiagonalStiffness& K) {
  static constexpr int upper[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  Parallel one_thread;
  if (nodal_pressure_) find_pressures(u, one_thread);
  Stiffness result;
  for (Index begin = 0; begin < tet_count(); begin += Lanes::count) {
    const Block& block = blocks_[begin / width];
    const int first = begin % width;
    const Lanes e(block, first, u);
    const Pack<Real> change = volume_change(e.H);
    Pack<Real> p_V = 0;
    if (nodal_pressure_) {
      p_V = Lanes::pressure_V(pressure_blocks_[begin / width], first, pressure_);
      keep_slopes(e, begin);
    }
    const int used = std::min<int>(Lanes::count, tet_count() - begin);
    for (int lane = 0; lane < used; ++lane)
      if (1 + Real(change[lane]) < result.smallest_volume_ratio) {
        result.smallest_volume_ratio = 1 + Real(change[lane]);
        result.smallest_tet = tet_of_slot_[begin + lane];
      }
    for (int c = 0; c < 4; ++c) {
      const Vec3<Pack<Real>> a = e.gradient(c);
      Mat3<Pack<Real>> own = svk_diagonal_block(e.H, a, e.lambda_V, e.mu_V);
      if (volume_term_) own += volume_diagonal_block(e.H, a, e.kappa_V);
      if (nodal_pressure_)
        for (int i = 0; i < 3; ++i) own(i, i) += p_V * a.cwiseProduct(a).sum();
      for (int i = 0; i < 6; ++i)
        for (int lane = 0; lane < used; ++lane)
          K(i, block.corners[c][first + lane]) += double(Real(own(upper[i][0], upper[i][1])[lane]));
    }
  }
  if (nodal_pressure_) nodes_.add_diagonal_stiffness(slopes_, K);
  return result;
}

template class ElementBlocks<float>;
template class ElementBlocks<double>;

}  // namespace lobe
