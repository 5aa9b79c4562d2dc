// Meshes of several bodies as one mesh, with one numbering.
#pragma once

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

// Adds a mesh as a further body. Its vertices and tetrahedra are numbered after those that are there. Where
// one of the two has fibres, those of the other are zero. Throws InputError for the 256th body.
void append_body(const TetMesh& body, const std::string& name, TetMesh& mesh);

// The tetrahedra of one body, with the vertices that they have in the whole mesh.
TetMesh tets_of_body(const TetMesh& mesh, int body);

// One body as append_body() has added it, with numbers of its own. Vertices of no tetrahedron belong to the
// body after them, the last ones to the last body. Throws InputError if vertices are not numbered by body.
TetMesh mesh_of_body(const TetMesh& mesh, int body);

}  // namespace lobe
