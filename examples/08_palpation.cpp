// Feel for a tumour: a probe presses on the liver, with a tumour of ten times the stiffness under its surface and
// without it. The table, in mm and N, is what a plot of force over indentation shows.
//
//   build/bin/08_palpation
//   pressed   with tumour   without      [mm], [N]
#include <lobe/lobe.h>

#include <cstdio>
#include <vector>

namespace {

constexpr double pressing_from = 0.2, pressing_till = 1.2, depth = 0.008;  // of the scene's probe [s], [m]

std::vector<double> forces(const lobe::Setup& setup, double frame) {
  lobe::World<float> world(setup);
  std::vector<double> found;
  while (world.time() < pressing_till - frame / 2) {
    if (!world.advance(frame).ok) return {};
    if (world.time() > pressing_from) found.push_back(-world.tools().lists().probes.front().force.z());
  }
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  const lobe::Scene scene = lobe::read_scene(argc > 1 ? argv[1] : "data/scenes/liver_palpation.json");
  lobe::Setup setup = lobe::resolve(scene, lobe::read_mesh(lobe::mesh_path(scene)).mesh).setup;
  const std::vector<double> with = forces(setup, scene.time.frame);
  for (lobe::Elastic& elastic : setup.materials) elastic = setup.materials.back();  // parenchyma everywhere
  const std::vector<double> without = forces(setup, scene.time.frame);
  if (with.empty() || without.size() != with.size()) return 1;
  std::printf("pressed   with tumour   without\n");
  for (std::size_t i = 4; i < with.size(); i += 5)
    std::printf("%6.1f %13.2f %9.2f\n", 1e3 * depth * double(i + 1) / double(with.size()), with[i],
                without[i]);
}
