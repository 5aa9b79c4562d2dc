// What Patches computes: forces by the kernels of an instruction set; energies and stiffness, which are asked
// for less often, by the registers that the whole library is compiled for.
#include <algorithm>

#include "lobe/region/element_lanes.h"
#include "lobe/region/patches.h"

namespace lobe {
namespace {

constexpr int upper[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};

}  // namespace

template <class Real>
PatchArrays<Real> Patches<Real>::arrays(Index p, const LocalVectors& u) const {
  const Elastic& elastic = materials_[layout_.patch(p).kind];
  const std::size_t first = std::size_t(p) * patch_blocks;
  return {blocks_.data() + first,
          (layout_.patch(p).items + width - 1) / width,
          nodal_pressure_ ? pressure_blocks_.data() + first : nullptr,
          pressure_.data(),
          u.data(),
          static_cast<Real>(elastic.element_lambda()),
          static_cast<Real>(elastic.mu),
          static_cast<Real>(kappa_),
          static_cast<Real>(elastic.guard_modulus()),
          static_cast<Real>(guard_below_)};
}

template <class Real>
void Patches<Real>::find_pressures(const Mat3X<Real>& u, Parallel& parallel) {
  parallel.for_ranges(layout_.patch_count(), sums_.patches_at_once, [&](Index begin, Index end) {
    LocalVectors local;
    std::array<Real, std::size_t(Layout::capacity)> strains;
    for (Index p = begin; p < end; ++p) {
      sums_.gather(layout_, p, u, local);
      kernels_.volume_strains(arrays(p, local), strains.data());
      for (Index i = 0; i < layout_.patch(p).items; ++i)
        volume_strain_[layout_.id_of(p * Layout::capacity + i)] = strains[i];
    }
  });
  nodes_.gather(volume_strain_, pressure_, parallel);
}

template <class Real>
void Patches<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, ElementPart part, Parallel& parallel) {
  if (kappa_ == 0 && guard_below_ == 0 && part == ElementPart::volume_term) return;
  if (kappa_ == 0 && part == ElementPart::both) part = ElementPart::svk;
  if (nodal_pressure_) find_pressures(u, parallel);
  sums_.add_forces(layout_, u, f, parallel,
                   [&](Index p, const LocalVectors& local, PaddedVector<Real>* sums) {
                     kernels_.add_forces(arrays(p, local), part, sums);
                   });
}

// Calls visit(lanes, arrays of the patch, block, first slot, tetrahedra in use), patch by patch.
template <class Real>
template <class Visit>
void Patches<Real>::for_lanes(const Mat3X<Real>& u, Visit&& visit) {
  using Lanes = ElementLanes<Pack<Real>>;
  Parallel one_thread;
  if (nodal_pressure_) find_pressures(u, one_thread);
  LocalVectors local;
  for (Index p = 0; p < layout_.patch_count(); ++p) {
    sums_.gather(layout_, p, u, local);
    const PatchArrays<Real> patch = arrays(p, local);
    for (Index i = 0; i < layout_.patch(p).items; i += Lanes::count)
      visit(Lanes(patch.blocks[i / width], i % width, patch.u), patch, i / width, p * Layout::capacity + i,
            std::min<int>(Lanes::count, layout_.patch(p).items - i));
  }
}

template <class Real>
double Patches<Real>::energy(const Mat3X<Real>& u) {
  using T = Pack<Real>;
  double sum = 0;
  for_lanes(u, [&](const auto& e, const PatchArrays<Real>& patch, Index block, Index slot, int used) {
    T W = svk_energy_density<T>(e.H, patch.lambda, patch.mu);
    if (kappa_ > 0) W += volume_energy_density<T>(e.H, patch.kappa);
    if (nodal_pressure_)
      W += pressure_energy_density<T>(e.H,
                                      e.pressure(patch.pressure_blocks[block], slot % width, patch.pressure));
    if (guard_below_ > 0) W += guard_energy_density<T>(e.H, patch.guard_modulus, patch.guard_below);
    W *= e.V;
    for (int lane = 0; lane < used; ++lane) sum += double(Real(W[lane]));
  });
  return sum;
}

// ∂(V tr E)/∂u_c = V F α_c.
template <class Real>
template <class Lanes>
void Patches<Real>::keep_slopes(const Lanes& e, Index first_slot, int used) {
  for (int c = 0; c < 4; ++c) {
    const Vec3<Pack<Real>> a = e.gradient(c), Fa = a + e.H.lazyProduct(a);
    for (int lane = 0; lane < used; ++lane)
      for (int d = 0; d < 3; ++d)
        slopes_(d, 4 * layout_.id_of(first_slot + lane) + c) =
            double(Real(e.V[lane])) * double(Real(Fa[d][lane]));
  }
}

template <class Real>
typename Patches<Real>::Stiffness Patches<Real>::add_diagonal_stiffness(const Mat3X<Real>& u,
                                                                        DiagonalStiffness& K) {
  using T = Pack<Real>;
  Stiffness result;
  for_lanes(u, [&](const auto& e, const PatchArrays<Real>& patch, Index block, Index slot, int used) {
    const T change = volume_change(e.H);
    for (int lane = 0; lane < used; ++lane)
      if (1 + Real(change[lane]) < result.smallest_volume_ratio) {
        result.smallest_volume_ratio = 1 + Real(change[lane]);
        result.smallest_tet = layout_.id_of(slot + lane);
      }
    T pressure = 0;
    if (nodal_pressure_) {
      pressure = e.pressure(patch.pressure_blocks[block], slot % width, patch.pressure);
      keep_slopes(e, slot, used);
    }
    const bool guarded = guard_below_ > 0 && e.any_below(patch.guard_below);
    const Index* vertices = layout_.vertices(slot / Layout::capacity);
    for (int c = 0; c < 4; ++c) {
      const Vec3<T> a = e.gradient(c);
      Mat3<T> own = svk_diagonal_block<T>(e.H, a, patch.lambda, patch.mu);
      if (kappa_ > 0) own += volume_diagonal_block<T>(e.H, a, patch.kappa);
      if (guarded) own += guard_diagonal_block<T>(e.H, a, patch.guard_modulus, patch.guard_below);
      if (nodal_pressure_)
        for (int i = 0; i < 3; ++i) own(i, i) += pressure * a.cwiseProduct(a).sum();
      const std::uint8_t* corners = &patch.blocks[block].corners[c][slot % width];
      for (int i = 0; i < 6; ++i) {
        const T entry = e.V * own(upper[i][0], upper[i][1]);
        for (int lane = 0; lane < used; ++lane) K(i, vertices[corners[lane]]) += double(Real(entry[lane]));
      }
    }
  });
  if (nodal_pressure_) nodes_.add_diagonal_stiffness(slopes_, K);
  return result;
}

template class Patches<float>;
template class Patches<double>;

}  // namespace lobe
