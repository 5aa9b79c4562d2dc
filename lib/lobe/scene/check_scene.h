// Checks a scene as far as that is possible without its mesh.
#pragma once

#include <vector>

#include "lobe/error.h"
#include "lobe/scene/scene.h"

namespace lobe {

// What the grammar cannot say: materials that are unstable, paths that go back in time, boxes turned inside
// out, normals of length zero, pictures of a time that is never reached.
std::vector<Fault> semantic_faults(const Scene& scene);

// For scenes built in code: everything that reading one from JSON would refuse. Throws InputError.
void check_scene(const Scene& scene);

}  // namespace lobe
