// The share of a mesh file that a rank reads: consecutive tetrahedra, and consecutive vertices. The vertices
// need not be those of the tetrahedra.
#pragma once

#include <filesystem>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_petsc/ranks.h"

namespace lobe::petsc {

struct MeshSlice {
  Index tets = 0, vertices = 0;  // numbers of the whole mesh
  Index first_tet = 0, first_vertex = 0;
  TetMesh mesh;               // corners are numbers of the whole mesh; labels always, fibres or none
  bool read_in_parts = true;  // false: rank 0 has read the whole file
};

// Each rank reads its bytes of a .vtu with raw, uncompressed arrays of tetrahedra alone (what lobe writes);
// rank 0 reads any other mesh and sends the others their slices. Throws InputError on all ranks.
MeshSlice read_slice(const Ranks& ranks, const std::filesystem::path& file);

// Takes a slice of a mesh that all ranks have.
MeshSlice slice_of(const Ranks& ranks, const TetMesh& mesh);

}  // namespace lobe::petsc
