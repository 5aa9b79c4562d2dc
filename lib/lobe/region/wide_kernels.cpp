// Compiled once per instruction set, LOBE_KERNELS, which is the namespace that everything here is in.
#include "lobe/region/wide_kernels.h"

#include "lobe/region/element_lanes.h"

namespace lobe::LOBE_KERNELS {
namespace {

// The kernels are flattened (LOBE_FLATTEN): all formulas inline, however often they are used elsewhere.
template <class Real, ElementPart part, bool nodal_pressure>
LOBE_FLATTEN void forces_of(const ElementArrays<Real>& arrays, Index begin, Index end, Real* rows) {
  using Lanes = ElementLanes<Pack<Real>>;
  constexpr int width = ElementBlock<Real>::width;
  for (Index b = begin; b < end; ++b)
    for (int first = 0; first < width; first += Lanes::count) {
      const Lanes e(arrays.blocks[b], first, arrays.u);
      Mat3<Pack<Real>> VP;
      if constexpr (part == ElementPart::volume_term)
        VP = volume_stress(e.H, e.kappa_V);
      else
        VP = svk_stress(e.H, e.lambda_V, e.mu_V);
      if constexpr (part == ElementPart::both) VP += volume_stress(e.H, e.kappa_V);
      if constexpr (nodal_pressure)
        VP += pressure_stress(e.H, Lanes::pressure_V(arrays.pressure_blocks[b], first, arrays.pressure));
      const Mat34<Pack<Real>> f = corner_forces(VP, e.alpha);
      Real* place = rows + std::size_t(b) * 12 * width + first;
      for (int i = 0; i < 12; ++i)
        f(i % 3, i / 3).copy_to(place + i * width, std::experimental::element_aligned);
    }
}

template <class Real>
void forces(const ElementArrays<Real>& arrays, ElementPart part, Index begin, Index end, Real* rows) {
  const bool nodal_pressure = arrays.pressure_blocks;
  if (part == ElementPart::volume_term)
    forces_of<Real, ElementPart::volume_term, false>(arrays, begin, end, rows);
  else if (part == ElementPart::svk && nodal_pressure)
    forces_of<Real, ElementPart::svk, true>(arrays, begin, end, rows);
  else if (part == ElementPart::svk)
    forces_of<Real, ElementPart::svk, false>(arrays, begin, end, rows);
  else if (nodal_pressure)
    forces_of<Real, ElementPart::both, true>(arrays, begin, end, rows);
  else
    forces_of<Real, ElementPart::both, false>(arrays, begin, end, rows);
}

template <class Real>
LOBE_FLATTEN void volume_strains(const ElementArrays<Real>& arrays, Index block, Real* row) {
  using Lanes = ElementLanes<Pack<Real>>;
  for (int first = 0; first < ElementBlock<Real>::width; first += Lanes::count) {
    const Lanes e(arrays.blocks[block], first, arrays.u);
    Pack<Real> V(&arrays.pressure_blocks[block].V[first], std::experimental::element_aligned);
    V *= strain_trace(e.H);
    V.copy_to(row + first, std::experimental::element_aligned);
  }
}

}  // namespace

extern const WideKernels<float> single_kernels{forces<float>, volume_strains<float>};
extern const WideKernels<double> double_kernels{forces<double>, volume_strains<double>};

}  // namespace lobe::LOBE_KERNELS
