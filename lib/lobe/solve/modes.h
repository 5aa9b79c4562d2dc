// The lowest natural frequencies of a body about an equilibrium, with lumped masses.
#pragma once

#include "lobe/numerics/sparse_factor.h"
#include "lobe/setup/setup.h"

namespace lobe {

// Returns ω of the lowest modes, ascending [rad/s], of small motions about u (3 × #vertices [m]), which is an
// equilibrium of the setup. By iteration of a subspace with K⁻¹ M. Throws InputError if the equilibrium is
// not stable, if the body has fewer degrees of freedom, or if the iteration does not converge. The stiffness
// of pressure that turns with the walls is left out.
Eigen::VectorXd lowest_frequencies(const Setup& setup, const Mat3X<double>& u, int count,
                                   const SparseFactorMaker& factor = make_ldlt);

}  // namespace lobe
