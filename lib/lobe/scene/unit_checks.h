// Estimates that reveal a mistake in units, such as the expected sag under gravity.
#pragma once

#include "lobe/setup/setup.h"

namespace lobe {

inline constexpr double standard_gravity = 9.81;  // [m/s²]

double box_diagonal(const TetMesh& mesh);  // diagonal of the bounding box [m]

// Says that a body of this size is unlike an organ in metres; empty if it is not.
std::string doubt_of_size(double diagonal);  // [m]

// How far a body of one material sags under its weight, to an order of magnitude: ρ g L²/E [m]. A column of
// height L has the strain ρ g L/E at its foot.
double expected_sag(const Elastic& material,
                    double gravity,  // g [m/s²]
                    double size);    // L [m]

}  // namespace lobe
