// The kinds of regions of a body, one row per kind, in the order in which their forces are summed. A new kind
// is a class with the functions below, and a row here. They are called a handful of times per step, and never
// per element.
#pragma once

#include <concepts>
#include <tuple>
#include <type_traits>

#include "lobe/condense/expanded.h"
#include "lobe/condense/precomputed.h"
#include "lobe/lattice/lattice_region.h"
#include "lobe/region/corotational.h"
#include "lobe/region/nonlinear.h"
#include "lobe/region/tensor_mass.h"

namespace lobe {

// Functions of every kind of region whose forces depend on displacements of its own vertices alone:
//   model                    RegionModel whose law its tetrahedra have
//   follow                   takes what enters, and leaves what leaves
//   add_forces               [N], of displacements [m]
//   energy                   [J]
//   add_diagonal_stiffness   [N/m], and the smallest det F
//   visit_patches            visit(layout, sums), of all that it evaluates in patches
// The other kinds, whose vertices follow an interface or a lattice, have what Regions asks of them by name.
template <class Region, class Real>
concept FreeRegion = requires(Region region, const Elements& elements, const RegionEdit& edit,
                              const Mat3X<Real>& u, Mat3X<Real>& f, DiagonalStiffness& K,
                              Parallel& parallel) {
  { Region::model } -> std::convertible_to<RegionModel>;
  region.follow(elements, edit);
  region.add_forces(u, f, parallel);
  { region.energy(u) } -> std::same_as<double>;
  { region.add_diagonal_stiffness(u, K, parallel) } -> std::same_as<SmallestVolumeRatio>;
  region.visit_patches([](const auto&, auto&) {});
};

template <class Real>
using RegionList = std::tuple<PrecomputedRegion<Real>, TensorMassRegion<Real>, NonlinearRegion<Real>,
                              CorotationalRegion<Real>, LatticeRegion<Real>, ExpandedRegion<Real>>;
static_assert(FreeRegion<TensorMassRegion<float>, float> && FreeRegion<NonlinearRegion<float>, float> &&
              FreeRegion<CorotationalRegion<float>, float> && FreeRegion<ExpandedRegion<float>, float>);

// Calls visit(region) of each row that has what `visit` calls, in their order.
template <class List, class Visit>
void visit_regions(List& list, Visit&& visit) {
  const auto call = [&](auto& region) {
    if constexpr (std::is_invocable_v<Visit&, decltype(region)>) visit(region);
  };
  std::apply([&](auto&... region) { (call(region), ...); }, list);
}

// Whether tetrahedra of this model are linear at all times. Pre-computed ones are not while expanded.
inline constexpr bool is_always_linear(RegionModel model) {
  return is_linear(model) && model != RegionModel::precomputed;
}
// The model that has all that a material asks for: its law, its volume term, its nodal pressure.
inline constexpr RegionModel full_model = RegionModel::nonlinear;

// A tangle of non-linear tetrahedra is unravelled as one of linear ones, which come back by themselves.
inline constexpr RegionModel tangling_model = RegionModel::nonlinear;
inline constexpr RegionModel unravelling_model = RegionModel::tensor_mass;

}  // namespace lobe
