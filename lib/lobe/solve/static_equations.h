// What loads and holds the vertices of a body in static equilibrium.
#pragma once

#include "lobe/fem/elements.h"
#include "lobe/setup/setup.h"
#include "lobe/solve/equilibrium.h"

namespace lobe {

// Equations with all loads but pressures, which depend on where the walls are (forces/pressure.h).
StaticEquations static_equations(const Setup& setup, const Elements& elements);

}  // namespace lobe
