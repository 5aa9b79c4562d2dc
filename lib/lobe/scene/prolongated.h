// The scene for the refinement of its mesh, on which it means the same body.
#pragma once

#include "lobe/mesh/refine.h"
#include "lobe/scene/scene.h"

namespace lobe {

// Selections by number, by count and by surfaces of the file take what lies between the vertices, within the
// tetrahedra or on the triangles that they select on the old mesh. All others are geometric, and stay. Throws
// InputError where such a selection does not suit the old mesh.
Scene prolongated(Scene scene, const TetMesh& old, const RefinedMesh& refined);

}  // namespace lobe
