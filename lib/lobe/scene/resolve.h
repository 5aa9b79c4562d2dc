// Resolves a scene on its mesh: which material and model every tetrahedron has, what is held, what is loaded.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lobe/linearity/proposal.h"
#include "lobe/scene/scene.h"

namespace lobe {

// What an entry of "boundary" holds or moves.
struct HeldEntry {
  std::string pointer;          // "/boundary/0"
  std::vector<Index> vertices;  // ascending
  std::vector<Axes> axes;       // held components of each vertex
  Index mesh_vertices = 0;      // vertices of the whole mesh; copies that cuts make are numbered from here on
};

struct Resolved {
  Setup setup;
  std::vector<HeldEntry> held;        // what is held, in the order of the entries
  std::vector<Gesture> gestures;      // gestures for automatic regions
  std::optional<Proposal> proposal;   // choice of automatic regions, where they were chosen
  std::vector<std::string> warnings;  // one line each; the scene can run all the same
};

struct ResolveOptions {
  // Whether automatic regions are chosen. That takes static solutions and measured steps: some seconds, or
  // minutes on a large mesh. If false, all of the body is nonlinear, as for a reference.
  bool choose_regions = true;
  std::function<void(double fraction)> progress = {};  // progress of choosing
};

// `mesh` is that of read_scene_mesh(), or has passed prepare(); it is not scaled by the scene's "mesh_scale"
// yet. Throws one InputError with everything that the scene asks for and that this mesh or this version does
// not have: selections that select nothing, tetrahedra without material, what is not available yet.
Resolved resolve(const Scene& scene, TetMesh mesh, const ResolveOptions& options = {});

}  // namespace lobe
