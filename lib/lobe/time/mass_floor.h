// The mass floor keeps the time step of a body that a blade has cut, by added mass. A copy of a tetrahedron
// T keeps a share φ of its volume V_T. Its stiffness and its mass are multiplied by φ, so its own
// frequencies do not change. But a vertex that is left with only its stiffest tetrahedra has a higher
// frequency than before. K_T is the stiffness matrix of T, 12 × 12 [N/m], and
// ω_T² = λ_max(K_T)/(ρV_T/4) [1/s²] is the same for all φ. With m_T,i = ρφV_T/4, the mass of T at its
// corner i [kg],
//
//   ω_max² ≤ max_i ( Σ_{T∋i} m_T,i ω_T² ) / m_i
//
// At vertices of divided tetrahedra m_i is raised to Σ m_T,i ω_T² / ω*². Others at the cut are not raised, so
// that ω_max ≤ ω* is measured and not proved (theory, section 9).
#pragma once

#include <optional>

#include "lobe/fem/elements.h"

namespace lobe {

struct MassFloor {
  double square = 0;                         // ω*² [1/s²]; 0: there is none
  std::optional<RegionModel> left_out = {};  // model whose tetrahedra never take steps; none: all take them

  // The least mass of a vertex [kg]: 0 where no tetrahedron is divided. `squares`, if given, stores
  // ω_T² of each tetrahedron of the start; 0: not computed yet.
  double at(const Elements& elements, Index vertex, std::vector<double>* squares = nullptr) const;
};

// ω_T² of a linear tetrahedron at rest [1/s²]: exact where it is isotropic, a bound with fibres.
double tet_square(const Elements& elements, Index tet);

}  // namespace lobe
