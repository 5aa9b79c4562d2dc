// Makes a scene and its mesh from what was painted.
#include <algorithm>
#include <cctype>
#include <iterator>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"
#include "lobe/setup/exclusions.h"
#include "painting.h"

namespace lobe::view {
namespace {

constexpr auto models = [] {
  std::array<RegionModel, region_model_names.size()> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = RegionModel(i);
  return all;
}();

}  // namespace

// Each combination of a former label, a material and a model gets a label, so that selectors of former labels
// still work.
int Painting::label(std::size_t place, int material, RegionModel model) const {
  const int former = static_cast<int>(place), count = static_cast<int>(materials().size());
  return 1 + int(std::size(models)) * (count * former + material) + static_cast<int>(model);
}

int Painting::label(Index tet) const {
  const auto place = std::lower_bound(labels_.begin(), labels_.end(), mesh_.labels[std::size_t(tet)]);
  return label(std::size_t(place - labels_.begin()), now_.material_of[std::size_t(tet)],
               now_.region_of[std::size_t(tet)]);
}

TetMesh Painting::mesh() const {
  TetMesh mesh = mesh_;
  for (Index t = 0; t < mesh.tet_count(); ++t) mesh.labels[std::size_t(t)] = label(t);
  return mesh;
}

// Selects the labels of tetrahedra that are chosen; nothing if there are none.
template <class Choice>
Selector Painting::labelled(const Choice& is_chosen) const {
  std::vector<int> labels;
  for (Index t = 0; t < mesh_.tet_count(); ++t)
    if (is_chosen(std::size_t(t))) labels.push_back(label(t));
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return {SelectLabel{std::move(labels)}};
}

void Painting::relabel(Selector& selector) const {
  const auto all_of = [&](std::vector<Selector>& parts) {
    for (Selector& part : parts) relabel(part);
  };
  if (auto* by_label = std::get_if<SelectLabel>(&selector.value)) {
    std::vector<int> labels;
    for (const int former : by_label->labels) {
      const auto place = std::lower_bound(labels_.begin(), labels_.end(), former);
      if (place == labels_.end() || *place != former) continue;
      for (int material = 0; material < static_cast<int>(materials().size()); ++material)
        for (const RegionModel model : models)
          labels.push_back(label(std::size_t(place - labels_.begin()), material, model));
    }
    by_label->labels = labels;
  } else if (auto* any = std::get_if<SelectAnyOf>(&selector.value)) {
    all_of(any->parts);
  } else if (auto* every = std::get_if<SelectAllOf>(&selector.value)) {
    all_of(every->parts);
  } else if (auto* inverted = std::get_if<SelectNot>(&selector.value)) {
    all_of(inverted->part);
  }
}

void Painting::add_regions(Scene& scene) const {
  scene.regions.clear();
  for (const RegionModel model : models) {
    Selector where = labelled([&](std::size_t t) { return now_.region_of[t] == model; });
    if (std::get<SelectLabel>(where.value).labels.empty()) continue;
    Region region{.name = name(model), .model = model, .where = {}, .pointer = {}};
    if (model == RegionModel::precomputed) region.frame = now_.frame;
    if (model == RegionModel::reduced) region.cell = cell_;
    region.where = std::move(where);
    scene.regions.push_back(std::move(region));
  }
}

void Painting::set_materials(Scene& scene) const {
  if (now_.material_of == material_at_first_) {
    for (Material& material : scene.materials)
      if (material.where) relabel(*material.where);
    return;
  }
  std::vector<Material> used;
  for (std::size_t i = 0; i < materials().size(); ++i) {
    Selector where = labelled([&](std::size_t t) { return now_.material_of[t] == static_cast<int>(i); });
    if (std::get<SelectLabel>(where.value).labels.empty()) continue;
    used.push_back(materials()[i]);
    used.back().where = std::move(where);
  }
  scene.materials = std::move(used);
}

void Painting::set_fixed(Scene& scene) const {
  for (Boundary& entry : scene.boundary) relabel(entry.where);
  if (now_.held == held_at_first_) return;
  std::erase_if(scene.boundary, [](const Boundary& entry) { return entry.kind == Boundary::Kind::fix; });
  SelectVertices vertices;
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (now_.held[std::size_t(v)]) vertices.vertices.push_back(v);
  if (vertices.vertices.empty()) return;
  scene.boundary.insert(scene.boundary.begin(),
                        Boundary{.where = Selector{std::move(vertices)}, .pointer = {}});
}

Scene Painting::scene(const std::filesystem::path& mesh) const {
  Scene scene = with_absolute_paths(scene_);
  scene.mesh = mesh;
  scene.mesh_scale = 1;  // that mesh is scaled
  scene.auto_regions.reset();
  add_regions(scene);
  const auto sleeps = [](RegionModel model) { return goes_with(Option::sleep, {option_of(model)}); };
  if (!std::all_of(regions().begin(), regions().end(), sleeps)) scene.time.sleep.reset();
  set_materials(scene);
  set_fixed(scene);
  for (Tool& tool : scene.tools)
    if (Selector* where = tool.where()) relabel(*where);
  return scene;
}

std::filesystem::path Painting::save(const std::filesystem::path& folder, const std::string& name,
                                     const std::function<Scene(Scene)>& finish) const {
  check_file_name(name);
  const std::filesystem::path file = folder / (name + ".json");
  Scene painted = scene(name + ".vtu");
  if (finish) painted = finish(std::move(painted));
  save_scene_mesh(mesh(), folder, name, painted);
  io::write_file(file, to_json(painted));
  return file;
}

void check_file_name(const std::string& name) {
  const bool is_plain = std::all_of(name.begin(), name.end(),
                                    [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
  if (name.empty() || name.size() > 60 || !is_plain)
    throw InputError("\"" + name + "\"",
                     "a name of letters, digits, _ and -, at most 60 of them, is expected");
}

}  // namespace lobe::view
