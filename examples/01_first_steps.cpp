// A bar held at one end sinks under its own weight, linear near the clamp, St Venant-Kirchhoff beyond.
//
//   build/bin/01_first_steps
//   after 3.00 s the tip has sunk by 44.3 mm
#include <lobe/lobe.h>

#include <cstdio>

int main() {
  lobe::Setup setup;
  setup.mesh = lobe::box_mesh({0.12, 0.02, 0.02}, 18, 3, 3);  // [m]
  const auto tets = std::size_t(setup.mesh.tet_count());
  setup.materials = {{4e4, 1e4, 1000}};  // λ, μ [Pa], ρ [kg/m³]
  setup.material_of.assign(tets, 0);
  setup.region_of.assign(tets, lobe::RegionModel::nonlinear);
  for (lobe::Index t = 0; t < setup.mesh.tet_count(); ++t)
    if (lobe::barycentre(setup.mesh, t).x() < 0.02) setup.region_of[t] = lobe::RegionModel::tensor_mass;
  for (lobe::Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, {0, 0, 0}});
  setup.gravity = {0, 0, -3};
  setup.damping = 20;  // [1/s]
  lobe::World<float> world(setup);
  for (int frame = 0; frame < 90; ++frame) world.advance(1.0 / 30);  // [s]
  std::printf("after %.2f s the tip has sunk by %.1f mm\n", world.time(),
              -1e3 * world.state().u.row(2).minCoeff());
}
