// The regions whose vertices all move by themselves, one row per kind, in the order of their sums. A new kind
// is a class with the functions below, and a row here. They are called a handful of times per step, and never
// per element.
#pragma once

#include <concepts>
#include <tuple>

#include "lobe/region/corotational.h"
#include "lobe/region/nonlinear.h"
#include "lobe/region/tensor_mass.h"

namespace lobe {

//   model                    RegionModel of the tetrahedra that it takes
//   follow                   takes what enters, and leaves what leaves
//   add_forces               [N], of displacements [m]
//   energy                   [J]
//   add_diagonal_stiffness   [N/m], and the smallest det F
//   visit_patches            visit(layout, sums), of all that it evaluates in patches
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

template <class Real, FreeRegion<Real>... Region>
using ListOfRegions = std::tuple<Region...>;

template <class Real>
using FreeRegions =
    ListOfRegions<Real, TensorMassRegion<Real>, NonlinearRegion<Real>, CorotationalRegion<Real>>;

template <class Real>
FreeRegions<Real> free_regions(Evaluator of_nonlinear) {
  return {TensorMassRegion<Real>(), NonlinearRegion<Real>(of_nonlinear), CorotationalRegion<Real>()};
}

}  // namespace lobe
