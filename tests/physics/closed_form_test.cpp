// Whole bodies against closed forms: positions are prescribed everywhere, nothing is solved.
#include <doctest/doctest.h>

#include <numbers>

#include "lobe/diagnostics/fields.h"
#include "lobe/sim/world.h"
#include "near.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

TEST_CASE("an infinitesimal rotation, free for the linear model, inflates the body by θ²") {
  const TetMesh mesh = irregular_box();
  World<double> world(setup_of(mesh, RegionModel::tensor_mass));
  for (const auto& [degrees, inflation] :
       {std::pair(15., 0.0685), std::pair(30., 0.2742), std::pair(45., 0.6169)}) {
    const double theta = degrees * std::numbers::pi / 180;
    State<double> state = world.state();
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      state.u.col(v) = theta * Vec3d(-mesh.points(1, v), mesh.points(0, v), 0);
    world.set_state(state);
    CHECK(world.forces().norm() < 1e-13);
    const double growth = current_volume(world.elements(), state.u) / total_volume(mesh) - 1;
    CHECK(growth == near(theta * theta, 1e-10));
    CHECK(growth == near(inflation, 1e-3));
  }
}
