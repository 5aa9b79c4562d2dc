// What ElementBlocks computes: forces by the kernels of an instruction set; energies and stiffness, which are asked
// for less often, by the registers that the whole library is compiled for.
#include <algorithm>

#include "lobe/region/element_blocks.h"
#include "lobe/region/element_lanes.h"

namespace lobe {

template <class Real>
void ElementBlocks<Real>::find_pressures(const Mat3X<Real>& u, Parallel& parallel) {
  parallel.for_ranges(Index(blocks_.size()), 2048 / width, [&](Index begin, Index end) {
    typename Block::Row volume_strains;
    for (Index b = begin; b < end; ++b) {
      kernels_.volume_strains(arrays(u), b, volume_strains.data());
      const Index used = std::min<Index>(width, tet_count() - b * width);
      for (Index lane = 0; lane < used; ++lane)
        volume_strain_[tet_of_slot_[b * width + lane]] = volume_strains[lane];
    }
  });
  nodes_.gather(volume_strain_, pressure_, parallel);
}

template <class Real>
void ElementBlocks<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, ElementPart part,
                                     Parallel& parallel) {
  if (!volume_term_ && part == ElementPart::volume_term) return;
  if (!volume_term_) part = ElementPart::svk;
  if (nodal_pressure_) find_pressures(u, parallel);
  parallel.for_ranges(Index(blocks_.size()), 2048 / width, [&](Index begin, Index end) {
    kernels_.forces(arrays(u), part, begin, end, corner_forces_.data());
  });
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
  using Lanes = ElementLanes<Pack<Real>>;
  Parallel one_thread;
  if (nodal_pressure_) find_pressures(u, one_thread);
  double sum = 0;
  for (Index b = 0; b < Index(blocks_.size()); ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(blocks_[b], first, u.data());
      Pack<Real> W = svk_energy_density(e.H, e.lambda_V, e.mu_V);
      if (volume_term_) W += volume_energy_density(e.H, e.kappa_V);
      if (nodal_pressure_)
        W += pressure_energy_density(e.H, Lanes::pressure_V(pressure_blocks_[b], first, pressure_.data()));
      for (int lane = 0; lane < Lanes::count; ++lane) sum += double(Real(W[lane]));
    }
  return sum;
}

// ∂(V tr E)/∂u_c = V F α_c, from the slot of the first of these tetrahedra on.
template <class Real>
template <class Lanes>
void ElementBlocks<Real>::keep_slopes(const Lanes& e, Index begin) {
  const typename Block::Row& V = pressure_blocks_[begin / width].V;
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
  using Lanes = ElementLanes<Pack<Real>>;
  static constexpr int upper[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  Parallel one_thread;
  if (nodal_pressure_) find_pressures(u, one_thread);
  Stiffness result;
  for (Index begin = 0; begin < tet_count(); begin += Lanes::count) {
    const Block& block = blocks_[begin / width];
    const int first = begin % width;
    const Lanes e(block, first, u.data());
    const Pack<Real> change = volume_change(e.H);
    Pack<Real> p_V = 0;
    if (nodal_pressure_) {
      p_V = Lanes::pressure_V(pressure_blocks_[begin / width], first, pressure_.data());
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
