// A scene on its mesh: which material and model every tetrahedron has, what is held, what is loaded.
#pragma once

#include <string>
#include <vector>

#include "lobe/scene/scene.h"

namespace lobe {

struct Resolved {
  Setup setup;
  std::vector<std::string> warnings;  // one line each; the scene can run all the same
};

// `mesh` has passed prepare(). Throws one InputError with everything that the scene asks and this mesh or
// this version cannot give: selections that select nothing, tetrahedra without material, what is not
// available yet.
Resolved resolve(const Scene& scene, TetMesh mesh);

}  // namespace lobe
