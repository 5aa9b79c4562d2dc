// An instrument in an engine's loop: take hold of the liver's left lobe, lift it, feel its stiffness, burn a
// notch, let go. Its tetrahedra are plain, as those of a Setup that names no element. The same gesture in
// examples/python/01_gesture.py has the edge-smoothed ones of scenes, which are less stiff: 2.97 N.
//
//   build/bin/05_instrument
//   lifted by 20 mm: the hand holds 3.52 N
//   burnt: 44 tetrahedra
//   let go after 2.00 s
#include <lobe/lobe.h>

#include <cstdio>

int main(int argc, char** argv) {
  lobe::Setup setup;
  setup.mesh = lobe::read_mesh(argc > 1 ? argv[1] : "data/meshes/liver_2k.vtu").mesh;
  setup.materials = {{4e4, 1e4, 1000}};
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), lobe::RegionModel::nonlinear);
  setup.damping = 20;
  std::vector<lobe::Index> lobe_tip;
  for (lobe::Index v = 0; v < setup.mesh.vertex_count(); ++v) {
    const lobe::Vec3d x = setup.mesh.points.col(v);
    if (x.x() < -0.02 && x.y() > 0.015) setup.prescribed.push_back({v, {0, 0, 0}});
    if ((x - lobe::Vec3d(0.082, -0.045, 0.035)).norm() < 0.02) lobe_tip.push_back(v);
  }
  lobe::World<float> world(setup);
  const double frame = 1.0 / 60;  // [s]

  const lobe::ToolId hand = world.tools().next_id();
  world.apply(lobe::TakeHold{"hand", lobe_tip});
  world.advance(frame);
  const lobe::Vec3d start = world.tools().grasp(hand)->centre;
  for (int i = 1; i <= 60; ++i) {  // where the hand is at the end of each frame
    world.apply(lobe::Lead{hand, {start + lobe::Vec3d(0, 0, 0.02 * i / 60)}});
    if (!world.advance(frame).ok) return 1;
  }
  const lobe::Grasp& holding = *world.tools().grasp(hand);
  std::printf("lifted by 20 mm: the hand holds %.2f N\n", holding.force.norm());

  const lobe::ToolId tip = world.tools().next_id();
  world.apply(lobe::BringCautery{"tip", 0.006, {0.03, -0.06, 0.03}});
  world.apply(lobe::SwitchTool{tip, true});
  lobe::Index burnt = 0;
  for (int i = 1; i <= 30; ++i) {
    world.apply(lobe::Lead{tip, {lobe::Vec3d(0.03, -0.06 + 0.001 * i, 0.03)}});
    burnt += world.advance(frame).tets_removed;
  }
  world.apply(lobe::SwitchTool{tip, false});
  std::printf("burnt: %d tetrahedra\n", burnt);

  world.apply(lobe::LetGo{hand});
  while (world.time() < 2 - frame / 2) world.advance(frame);
  std::printf("let go after %.2f s\n", world.time());
}
