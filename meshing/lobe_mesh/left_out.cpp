// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// In place of what a build without LOBE_MESH_ALL leaves out: each step says so and how to have it.
#include <string>

#include "lobe/mesh/tet_mesh.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

[[noreturn]] void refuse(const char* what) {
  throw MeshingFailure(std::string("this build of lobe-mesh cannot ") + what +
                       ": it was compiled for the demo; `./dev build` compiles all of it");
}

}  // namespace

Surface repair_in_steps(const Surface&, double, RepairReport&, const std::function<void(const Surface&)>&) {
  refuse("repair surfaces");
}
Surface alpha_wrap(const Surface&, double, double) { refuse("wrap surfaces"); }
Surface remesh(const Surface&, const std::vector<Polyline>&, double) { refuse("remesh surfaces for TetGen"); }
TetMesh mesh_image_with_cgal(const Model&, const MeshingRun&) { refuse("mesh label images"); }

}  // namespace lobe::meshing
