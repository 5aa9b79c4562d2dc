// Fibre directions from formulas: one unit vector per tetrahedron of a selection, at its barycentre. They
// depend on positions alone, whatever the numbering.
#pragma once

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

// Sets fibres that run in circles around an axis (vessels, sphincters): axis × (barycentre − point). Throws
// InputError at a tetrahedron whose barycentre lies on the axis.
void set_fibres_around(const Vec3d& point, const Vec3d& axis, const std::vector<Index>& tets, TetMesh& mesh,
                       const std::string& place);

// Sets fibres along the gradient of a harmonic function, which is 0 on some vertices and 1 on others and has
// no flux through the rest of the selection's surface (rule-based fibres). It solves Laplace's equation with
// linear elements and one sparse factor. Where all corners of a tetrahedron have the same given value, the
// gradient is that of its neighbours. Throws InputError if a set has no vertex of the selection, if both
// share one, or if a part of the selection has none of either.
void set_harmonic_fibres(const std::vector<Index>& from, const std::vector<Index>& to,
                         const std::vector<Index>& tets, TetMesh& mesh, const std::string& place);

}  // namespace lobe
