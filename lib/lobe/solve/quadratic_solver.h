// Static equilibrium of the same body with 10-node tetrahedra: the truth against which the error of the plain
// tetrahedra on a mesh is measured. Its error falls with the third power of the edge in L2, where loads and
// what is held are smooth.
#pragma once

#include "lobe/solve/equilibrium.h"
#include "lobe/solve/quadratic_mesh.h"

namespace lobe {

// The equations of a setup on the nodes of its quadratic mesh. The same body is held as on the mesh itself:
// an edge whose ends are given moves with them. Gravity and tractions are integrated with the functions of
// the nodes. Forces on vertices act there.
StaticEquations quadratic_equations(const Setup& setup, const QuadraticMesh& mesh);
// The equations with these nodes prescribed in place of the setup's; `vertex` is the number of a node.
StaticEquations quadratic_equations(const Setup& setup, const QuadraticMesh& mesh,
                                    const std::vector<PrescribedVertex>& given);

// The result is that of the nodes, of which the first are the vertices; volume ratios are those at
// points of integration. Tools are ignored. Throws InputError as solve_static() does.
StaticResult solve_static_quadratic(const Setup& setup, const StaticOptions& options = {});
StaticResult solve_static_quadratic(const Setup& setup, const QuadraticMesh& mesh,
                                    const StaticEquations& equations, const StaticOptions& options = {});

}  // namespace lobe
