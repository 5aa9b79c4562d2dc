// A project of somebody else's: a bar under its own weight.
#include <lobe/lobe.h>
#include <cstdio>

int main() {
  lobe::Setup setup;
  setup.mesh = lobe::box_mesh({0.1, 0.02, 0.02}, 10, 2, 2);
  setup.materials = {{4e4, 1e4, 1000}};
  setup.material_of.assign(240, 0);
  setup.region_of.assign(240, lobe::RegionModel::nonlinear);
  for (lobe::Index v = 0; v < setup.mesh.vertex_count(); ++v)
    if (setup.mesh.points(0, v) == 0) setup.prescribed.push_back({v, {0, 0, 0}});
  setup.gravity = {0, 0, -3};
  setup.damping = 20;
  lobe::World<double> world(setup);
  const lobe::Frames frames = lobe::frames_of({.duration = 4, .frame = 1.0 / 30});
  for (int i = 0; i < frames.count; ++i) world.advance(frames.length);
  std::printf("%.3f s: %.2f mm\n", world.time(), 1e3 * world.state().u(2, setup.mesh.vertex_count() - 1));
}
