// What `lobe bench accuracy` plays: scenes, each on meshes of several sizes.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/benchmarks.h"
#include "lobe/mesh/refine.h"
#include "lobe/scene/each_selector.h"
#include "lobe/scene/scene.h"

namespace lobe::bench {

struct Case {
  std::string name;  // of the scene's file; letters, digits, '_' and '-'
  Scene scene;
  std::vector<TetMesh> meshes;  // ascending in size
  TetMesh refine = {};          // total errors are against its refinement; empty: the largest of the meshes
};

// The shipped scenes, or those of the options on their own meshes. Throws InputError.
std::vector<Case> make_cases(const Options& options);

// The shipped liver alone, or the user's scenes; also on the meshes of the options.
std::vector<Case> make_organs(const Options& options);

}  // namespace lobe::bench
