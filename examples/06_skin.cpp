// What an engine draws: the surface of the tetrahedra with normals and cut faces, in buffers of which only
// what changed is copied, and a finer skin that they carry.
//
//   build/bin/06_skin
//   surface: 670 triangles, then 682 of which 27 are burnt; copied 52 slots
//   skin: 5766 triangles, then 5631
#include <lobe/lobe.h>

#include <algorithm>
#include <cstdio>
#include <string>

int main(int argc, char** argv) {
  const std::string data = argc > 1 ? argv[1] : "data";
  lobe::Setup setup;
  setup.mesh = lobe::read_mesh(data + "/meshes/liver_2k.vtu").mesh;
  setup.materials = {{4e4, 1e4, 1000}};
  setup.material_of.assign(std::size_t(setup.mesh.tet_count()), 0);
  setup.region_of.assign(std::size_t(setup.mesh.tet_count()), lobe::RegionModel::nonlinear);
  setup.prescribed = {{0, {0, 0, 0}}, {1, {0, 0, 0}}, {2, {0, 0, 0}}};
  lobe::Skin skin(lobe::read_obj(data + "/liver.obj"), setup.mesh);
  lobe::World<float> world(setup);
  world.on_cut([&](const auto& topology, const auto& edit) { skin.follow(topology, edit, world.grains()); });

  const lobe::SurfaceMesh& surface = world.surface().mesh();
  const std::uint64_t seen = surface.revision;  // what the graphics card has
  const lobe::Index triangles = surface.triangle_count(), skin_triangles = skin.mesh().triangle_count();
  world.apply(lobe::BringCautery{"tip", 0.008, {0.03, -0.06, 0.03}});
  world.apply(lobe::SwitchTool{1, true});
  for (int i = 1; i <= 10; ++i) {
    world.apply(lobe::Lead{1, {lobe::Vec3d(0.03, -0.06 + 0.003 * i, 0.03)}});
    if (!world.advance(1.0 / 60).ok) return 1;
  }
  const auto changed = surface.changed_triangles.since(seen);  // none: copy all of it
  const auto burnt = std::count(surface.cut.begin(), surface.cut.end(), 2);
  std::printf("surface: %d triangles, then %d of which %d are burnt; copied %d slots\n", triangles,
              surface.triangle_count(), static_cast<int>(burnt),
              static_cast<int>(changed ? changed->size() : surface.triangles.size()));

  lobe::Mat3X<float> x, normals, skin_x, skin_normals;  // a frame: positions and normals of both
  lobe::update_positions<float>(surface, world.elements().points.view(), world.state().u, x);
  lobe::update_normals(surface, x, normals);
  skin.update(world.elements().points.view(), world.state().u, skin_x, skin_normals);
  std::printf("skin: %d triangles, then %d\n", skin_triangles, skin.mesh().triangle_count());
}
