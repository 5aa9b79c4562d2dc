// Checks a scene as far as that is possible without its mesh.
#pragma once

#include <vector>

#include "lobe/error.h"
#include "lobe/scene/scene.h"

namespace lobe {

// Returns faults that the grammar cannot find: materials that are unstable, paths that go back in time, boxes
// turned inside out, normals of length zero, pictures of a time that is never reached.
std::vector<Fault> semantic_faults(const Scene& scene);

// Throws InputError for a scene built in code if it has any fault for which a JSON file would be refused.
void check_scene(const Scene& scene);

}  // namespace lobe
