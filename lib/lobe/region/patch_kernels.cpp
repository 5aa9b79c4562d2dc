// What Patches computes. Forces and stiffness come from the kernels of an instruction set. Energies are asked
// for less often and use the registers for which the whole library is compiled.
#include <algorithm>

#include "lobe/fem/law.h"
#include "lobe/region/element_lanes.h"
#include "lobe/region/patches.h"
#include "lobe/region/viscous_lanes.h"

namespace lobe {

template <class Real>
PatchArrays<Real> Patches<Real>::arrays(Index p, const LocalVectors& u) const {
  const std::size_t first = std::size_t(p) * patch_blocks;
  return {blocks_.data() + first,
          (layout_.patch(p).items + width - 1) / width,
          nodal_pressure_ ? pressure_blocks_.data() + first : nullptr,
          pressure_.data(),
          u.data(),
          fibres_ ? fibre_blocks_.data() + first : nullptr,
          laws_[layout_.patch(p).kind].template as<Real>()};
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
void Patches<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  // Smoothing domains compute the forces of their tetrahedra (tet_owners.h). Their blocks here are for what
  // is asked for less often: energy, det F, and the stiffness of volume term and guard.
  const auto is_of_domains = [](const auto& law) { return law.terms.solid == MaterialLaw::none; };
  if (std::all_of(laws_.begin(), laws_.end(), is_of_domains)) return;
  if (nodal_pressure_) find_pressures(u, parallel);
  // Collapse is rare. So other patches only compute the smallest det F. A patch with an element below the
  // threshold (with a margin for rounding) is evaluated again, with the guard.
  sums_.add_forces(layout_, u, f, parallel,
                   [&](Index p, const LocalVectors& local, PaddedVector<Real>* sums) {
                     const PatchArrays<Real> patch = arrays(p, local);
                     if (is_of_domains(patch.law)) return;
                     if (const std::uint16_t kind = layout_.patch(p).kind; viscosity_.terms(kind) > 0)
                       return viscous_kernels_.add_forces(patch, viscosity_.arrays(p, kind), sums);
                     const Guarding guarding = patch.law.terms.guard ? Guarding::asked : Guarding::off;
                     const Real smallest = kernels_.add_forces(patch, guarding, sums);
                     if (smallest >= Real(1.01f) * patch.law.guard_threshold) return;
                     std::fill_n(sums, layout_.patch(p).vertices, PaddedVector<Real>{});
                     kernels_.add_forces(patch, Guarding::acting, sums);
                   });
}

// Calls visit(lanes, arrays of the patch, block, first slot, tetrahedra in use).
template <class Real>
template <class Visit>
void Patches<Real>::for_lanes(Index p, const Mat3X<Real>& u, Visit&& visit) {
  using Lanes = ElementLanes<Pack<Real>>;
  LocalVectors local;
  sums_.gather(layout_, p, u, local);
  const PatchArrays<Real> patch = arrays(p, local);
  for (Index i = 0; i < layout_.patch(p).items; i += Lanes::count)
    if (!visit(Lanes(patch.blocks[i / width], i % width, patch.u), patch, i / width, p * Layout::capacity + i,
               std::min<int>(Lanes::count, layout_.patch(p).items - i)))
      return;
}

template <class Real>
double Patches<Real>::energy(const Mat3X<Real>& u) {
  using T = Pack<Real>;
  if (tet_count() == 0) return 0;
  Parallel one_thread;
  if (nodal_pressure_) find_pressures(u, one_thread);
  double sum = 0;
  const auto add = [&](const auto& e, const PatchArrays<Real>& patch, Index block, Index slot, int used) {
    Law<T> law = patch.law.template as<T>();
    if (nodal_pressure_)
      law.pressure = e.pressure(patch.pressure_blocks[block], slot % width, patch.pressure);
    if (law.terms.has_direction()) law.direction = e.direction(patch.fibre_blocks[block], slot % width);
    T W = law_energy_density(law, e.H);
    const Index p = slot / Layout::capacity;
    if (const std::uint16_t kind = layout_.patch(p).kind; viscosity_.terms(kind) > 0)
      W += branch_energy(viscosity_.arrays(p, kind), block, slot % width, green_strain(e.H));
    W *= e.V;
    for (int lane = 0; lane < used; ++lane) sum += double(Real(W[lane]));
    return true;
  };
  for (Index p = 0; p < layout_.patch_count(); ++p) for_lanes(p, u, add);
  return sum;
}

// ∂(V θ)/∂u_c = V ∂θ/∂F α_c.
template <class Real>
void Patches<Real>::find_slopes(const Mat3X<Real>& u) {
  const auto keep = [&](const auto& e, const PatchArrays<Real>& patch, Index, Index slot, int used) {
    const Mat3<Pack<Real>> D = pressure_slope_less_one(e.H, patch.law.terms.solid);
    for (int c = 0; c < 4; ++c) {
      const Vec3<Pack<Real>> a = e.gradient(c), slope = a + D.lazyProduct(a);
      for (int lane = 0; lane < used; ++lane)
        for (int d = 0; d < 3; ++d)
          slopes_(d, 4 * layout_.id_of(slot + lane) + c) =
              double(Real(e.V[lane])) * double(Real(slope[d][lane]));
    }
    return true;
  };
  for (Index p = 0; p < layout_.patch_count(); ++p) for_lanes(p, u, keep);
}

// The tetrahedron of the smallest det F is searched in its patch only, until it is found.
template <class Real>
typename Patches<Real>::Stiffness Patches<Real>::smallest_of(const std::vector<Real>& ratios,
                                                             const Mat3X<Real>& u) {
  Stiffness result;
  const auto smallest = std::min_element(ratios.begin(), ratios.end());
  if (smallest == ratios.end() || !(*smallest < 1)) return result;
  const auto find = [&](const auto& e, const PatchArrays<Real>&, Index, Index slot, int used) {
    const auto change = volume_change(e.H);
    for (int lane = 0; lane < used; ++lane)
      if (1 + Real(change[lane]) < result.smallest_volume_ratio) {
        result.smallest_volume_ratio = 1 + Real(change[lane]);
        result.smallest_tet = layout_.id_of(slot + lane);
      }
    return result.smallest_volume_ratio > double(*smallest);
  };
  for_lanes(static_cast<Index>(smallest - ratios.begin()), u, find);
  return result;
}

// Two passes compute three entries each, which are added up like forces.
template <class Real>
typename Patches<Real>::Stiffness Patches<Real>::add_diagonal_stiffness(const Mat3X<Real>& u,
                                                                        DiagonalStiffness& K,
                                                                        Parallel& parallel) {
  if (tet_count() == 0) return {};
  sums_.forget();  // the entries overwrite the stored forces
  if (nodal_pressure_) find_pressures(u, parallel);
  Mat3X<Real> entries(3, layout_.places().vertex_count());  // of the stiffness per vertex [N/m]
  ratios_.resize(std::size_t(layout_.patch_count()));
  for (const StiffnessPart part : {StiffnessPart::diagonal, StiffnessPart::off_diagonal}) {
    entries.setZero();
    sums_.add_forces(layout_, u, entries, parallel,
                     [&](Index p, const LocalVectors& local, PaddedVector<Real>* sums) {
                       const PatchArrays<Real> patch = arrays(p, local);
                       ratios_[p] = kernels_.add_stiffness(patch, part, sums);
                       if (const std::uint16_t kind = layout_.patch(p).kind; viscosity_.terms(kind) > 0)
                         viscous_kernels_.add_stiffness(patch, viscosity_.arrays(p, kind), part, sums);
                     });
    const std::array<int, 3> rows =
        part == StiffnessPart::diagonal ? std::array{0, 3, 5} : std::array{1, 2, 4};
    for (Index v = 0; v < entries.cols(); ++v)
      for (int i = 0; i < 3; ++i) K(rows[i], v) += double(entries(i, v));
  }
  if (nodal_pressure_) {
    find_slopes(u);
    nodes_.add_diagonal_stiffness(slopes_, K);
  }
  return smallest_of(ratios_, u);
}

}  // namespace lobe
