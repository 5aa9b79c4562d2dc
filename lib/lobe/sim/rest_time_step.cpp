#include "lobe/sim/rest_time_step.h"

#include "lobe/forces/region_list.h"
#include "lobe/sim/world.h"

namespace lobe {

double rest_time_step(const TetMesh& mesh, const Elastic& elastic) {
  Setup setup;
  setup.mesh = mesh;
  setup.materials = {elastic};
  setup.material_of.assign(std::size_t(mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(mesh.tet_count()), full_model);
  return World<double>(setup).time_step_limit();
}

}  // namespace lobe
