// Pressure on faces of the body, which turns and grows with them (Setup::pressures). A face with the corners
// a, b, c, counter-clockwise seen from outside, has the area vector A = (b − a) × (c − a)/2; a uniform
// pressure p gives each of its corners the force −p A/3.
//
// On a closed surface, or where the rim is held, the force has a potential, −p times the volume that is
// enclosed.
#pragma once

#include <vector>

#include "lobe/fem/elements.h"
#include "lobe/setup/setup.h"

namespace lobe {

// f −= share · p A/3 at all corners, with positions X + u. If a blade has left only a part of a tetrahedron,
// its face bears that part's share of the force.
template <class Real>
void add_pressures(const std::vector<FacePressure>& pressures, const Elements& elements, double share,
                   const Mat3X<Real>& u,  // 3 × #vertices [m]
                   Mat3X<Real>& f);       // 3 × #vertices [N]

}  // namespace lobe
