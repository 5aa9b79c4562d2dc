// Gives the selectors of a scene the groups that only the mesh's file names.
#pragma once

#include "lobe/io/mesh_io.h"
#include "lobe/scene/scene.h"

namespace lobe {

// Sets the triangles of every {"surface": …}, and the numbers of every label that is a name; of several
// bodies, in each that has the name. Call it between read_scene_mesh() and resolve(). Throws one InputError
// for all names that the file does not have; it lists those that there are.
void bind_groups(const MeshFile& mesh, Scene& scene);

}  // namespace lobe
