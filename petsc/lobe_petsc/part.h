// The part of a body that a rank has: its tetrahedra with all their vertices.
#pragma once

#include "lobe/mesh/outer_faces.h"
#include "lobe_petsc/mesh_slice.h"

namespace lobe::petsc {

// Every tetrahedron belongs to one rank. A vertex is owned by the lowest rank that has a tetrahedron of it.
// The others have it as a ghost. Local vertices are the owned ones, along a Hilbert curve, and then the
// ghosts.
struct Part {
  TetMesh mesh;                          // local numbers; prepared
  std::vector<Index> tet_number;         // numbers in the file, ascending
  std::vector<Index> vertex_number;      // numbers in the file
  std::vector<PetscInt> global;          // row of blocks of each local vertex in matrices and vectors
  Index owned = 0;                       // local vertices 0 … owned − 1
  std::vector<TetFace> outer;            // faces of the whole body's surface
  Index all_tets = 0, all_vertices = 0;  // numbers of the file
  Index all_owned = 0;                   // vertices that tetrahedra use, over all ranks

  Index vertex_of(Index number) const;  // local, −1 if it is not here
  Index tet_of(Index number) const;

  std::vector<std::pair<Index, Index>> by_number;  // vertices: number in the file, local; ascending
};

// PT-Scotch divides the graph of tetrahedra that share faces into as many parts as there are ranks. Throws
// InputError on all ranks for a mesh that prepare() refuses, for a face of three tetrahedra, and for a rank
// that is left without a tetrahedron.
Part make_part(const Ranks& ranks, MeshSlice slice, const std::string& name);

}  // namespace lobe::petsc
