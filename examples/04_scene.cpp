// A scene from its JSON file, played from code: the resection of the README.
//
//   build/bin/04_scene data/scenes/liver_resection.json
//   4.40 s: 690 tetrahedra burnt, 9609 left
#include <lobe/lobe.h>

#include <cstdio>

int main(int argc, char** argv) try {
  const lobe::Scene scene = lobe::read_scene(argc > 1 ? argv[1] : "data/scenes/liver_resection.json");
  const lobe::Resolved resolved = lobe::resolve(scene, lobe::read_scene_mesh(scene).mesh);
  lobe::World<float> world(resolved.setup);
  lobe::Index burnt = 0;
  const lobe::Frames frames = lobe::frames_of(scene.time);
  for (int i = 0; i < frames.count; ++i) {
    const lobe::Report report = world.advance(frames.length);  // tools, cuts, as many steps as are stable
    if (!report.ok) return 1;                                  // it says why; no NaN ever gets out
    burnt += report.tets_removed;
  }
  std::printf("%.2f s: %d tetrahedra burnt, %d left\n", world.time(), burnt,
              world.elements().topology.alive_count());
} catch (const lobe::InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
