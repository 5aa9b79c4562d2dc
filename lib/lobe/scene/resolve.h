// Resolves a scene on its mesh: which material and model every tetrahedron has, what is held, what is loaded.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lobe/linearity/proposal.h"
#include "lobe/scene/scene.h"

namespace lobe {

struct Resolved {
  Setup setup;
  std::vector<Gesture> gestures;  // of automatic regions
  std::optional<Proposal>
      proposal;  // of automatic regions, once propose() has chosen them: all are nonlinear before
  std::vector<std::string> warnings;  // one line each; the scene can run all the same
};

// `mesh` has passed prepare(). Throws one InputError with everything that the scene asks and this mesh or
// this version cannot give: selections that select nothing, tetrahedra without material, what is not
// available yet.
Resolved resolve(const Scene& scene, TetMesh mesh);

// Chooses the regions where the scene leaves that to lobe, and whether those that it wants precomputed had
// better be tensor-mass; warnings say what was found. Takes minutes on a large mesh.
void propose(const Scene& scene, Resolved& resolved,
             const std::function<void(double fraction)>& progress = {});

}  // namespace lobe
