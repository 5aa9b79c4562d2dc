// Finds the vertices, tetrahedra or boundary faces that a selector selects on a mesh.
//
// A tetrahedron is selected by its barycentre, a boundary face when its three vertices are. Where one names
// a surface, boundary faces are selected one by one, and each other part by their three vertices. Boxes,
// spheres and planes include their surface; "above" and "below" both include the plane. Vertices of no
// tetrahedron are never selected. O(#vertices + #tetrahedra) per simple selector.
#pragma once

#include <string>
#include <vector>

#include "lobe/mesh/outer_faces.h"
#include "lobe/scene/scene.h"

namespace lobe {

// Results are ascending. An index beyond the mesh throws InputError; `place` is the selector's JSON pointer.
std::vector<Index> select_vertices(const Selector& selector, const TetMesh& mesh,
                                   const std::string& place = "");
std::vector<Index> select_tets(const Selector& selector, const TetMesh& mesh, const std::string& place = "");
std::vector<TetFace> select_faces(const Selector& selector, const TetMesh& mesh,
                                  const std::vector<TetFace>& faces, const std::string& place = "");

}  // namespace lobe
