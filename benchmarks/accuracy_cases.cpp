#include "benchmarks/accuracy_cases.h"

#include <algorithm>
#include <cmath>

#include "lobe/error.h"
#include "lobe/io/mesh_io.h"
#include "lobe/mesh/generators.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/select.h"

namespace lobe::bench {
namespace {

namespace fs = std::filesystem;

const fs::path data = LOBE_DATA_DIR;

// ---- The shipped scenes

int cells(int tets, double per_cube) { return std::max(1, int(std::lround(std::cbrt(tets / per_cube)))); }

TetMesh beam(int tets) {
  const int n = cells(tets, 24);
  return box_mesh({0.12, 0.03, 0.03}, 4 * n, n, n);
}

TetMesh cylinder(int tets) {
  const int rings = cells(tets, 90);
  return cylinder_mesh(0.02, 0.1, rings, 5 * rings);
}

Case generated(const char* name, TetMesh (*mesh)(int), const std::vector<int>& tets) {
  Case made{name, read_scene(data / "scenes" / ("accuracy_" + std::string(name) + ".json")), {}};
  for (int count : tets) made.meshes.push_back(mesh(count));
  return made;
}

Case liver(bool quick) {
  Case made{"liver", read_scene(data / "scenes/accuracy_liver.json"), {}};
  made.meshes.push_back(read_mesh(data / "meshes/liver_2k.vtu").mesh);
  if (!quick) made.meshes.push_back(read_mesh(data / "meshes/liver_10k.vtu").mesh);
  return made;
}

std::vector<Case> shipped_cases(const Options& options) {
  if (!options.meshes.empty())
    throw InputError("--mesh", "is a further mesh of a scene; name that by --scene");
  if (!options.refine.empty()) throw InputError("--refine", "is a mesh of a scene; name that by --scene");
  const auto sizes = [&](const std::vector<int>& all, const std::vector<int>& quick) {
    if (!options.tets.empty()) return options.tets;
    return options.quick ? quick : all;
  };
  return {generated("beam", beam, sizes({648, 1536, 5184}, {192, 648})),
          generated("cylinder", cylinder, sizes({720, 2430, 5760}, {720})), liver(options.quick)};
}

// ---- The user's scenes

std::string name_of(const fs::path& file) {
  std::string name = file.stem().string();
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return !(c < 128 && std::isalnum(c)) && c != '_' && c != '-'; }, '_');
  return name;
}

Case users_case(const fs::path& file, const Options& options) {
  Case made{name_of(file), read_scene(file), {}};
  made.meshes.push_back(read_scene_mesh(made.scene).mesh);
  for (const fs::path& mesh : options.meshes) made.meshes.push_back(read_mesh(mesh).mesh);
  if (options.refine.empty()) return made;
  if (selects_by_number(made.scene))
    throw InputError("--refine", "selectors by number or by count mean something else on another mesh");
  made.refine = read_mesh(options.refine).mesh;
  return made;
}

std::vector<Case> users_cases(const Options& options) {
  if (!options.tets.empty())
    throw InputError("--tets",
                     "sizes the shipped beam and cylinder; give your scene further meshes by --mesh");
  if (options.scenes.size() > 1 && !options.meshes.empty())
    throw InputError("--mesh", "goes with one --scene only");
  if (options.scenes.size() > 1 && !options.refine.empty())
    throw InputError("--refine", "goes with one --scene only");
  std::vector<Case> cases;
  for (const fs::path& file : options.scenes) cases.push_back(users_case(file, options));
  return cases;
}

}  // namespace

std::vector<Case> make_cases(const Options& options) {
  std::vector<Case> cases = options.scenes.empty() ? shipped_cases(options) : users_cases(options);
  for (Case& one : cases) {
    std::stable_sort(one.meshes.begin(), one.meshes.end(),
                     [](const TetMesh& a, const TetMesh& b) { return a.tet_count() < b.tet_count(); });
    if (options.quick && !options.scenes.empty()) one.meshes.resize(1);
  }
  for (std::size_t i = 0; i < cases.size(); ++i)
    while (std::any_of(cases.begin(), cases.begin() + std::ptrdiff_t(i),
                       [&](const Case& other) { return other.name == cases[i].name; }))
      cases[i].name += '_';
  return cases;
}

std::vector<Case> make_organs(const Options& options) {
  if (!options.scenes.empty()) return users_cases(options);
  if (!options.tets.empty()) throw InputError("bench hybrid", "has the sizes of its meshes, not --tets");
  Case organ = liver(options.quick);
  for (const fs::path& mesh : options.meshes) organ.meshes.push_back(read_mesh(mesh).mesh);
  return {organ};
}

}  // namespace lobe::bench
