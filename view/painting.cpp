#include "painting.h"

#include <algorithm>
#include <cctype>
#include <numeric>

#include "lobe/error.h"
#include "lobe/io/atomic_file.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/select.h"
#include "lobe/scene/write_scene.h"

namespace lobe::view {
namespace {

constexpr std::size_t most_undone = 100;
constexpr RegionModel models[] = {RegionModel::tensor_mass, RegionModel::precomputed, RegionModel::nonlinear};
constexpr const char* region_names[] = {"tensor-mass", "pre-computed", "non-linear"};

// At most `radius` away; the nearest one where there is none. `of` are columns of points.
std::vector<Index> within(const Mat3X<double>& points, const std::vector<Index>& of, const Vec3d& at,
                          double radius) {
  std::vector<Index> found;
  Index nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const Index i : of) {
    const double distance = (points.col(i) - at).norm();
    if (distance <= radius) found.push_back(i);
    if (distance < least) {
      least = distance;
      nearest = i;
    }
  }
  if (found.empty() && nearest >= 0) found.push_back(nearest);
  return found;
}

std::vector<Index> all(Index count) {
  std::vector<Index> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

std::vector<std::uint8_t> fixed_vertices(const Scene& scene, const TetMesh& mesh) {
  std::vector<std::uint8_t> fixed(static_cast<std::size_t>(mesh.vertex_count()), 0);
  for (const Boundary& entry : scene.boundary)
    if (entry.kind == Boundary::Kind::fix)
      for (const Index v : select_vertices(entry.where, mesh)) fixed[std::size_t(v)] = 1;
  return fixed;
}

std::vector<int> distinct(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

}  // namespace

Painting::Painting(Scene scene, const Resolved& resolved)
    : scene_(std::move(scene)),
      mesh_(resolved.setup.mesh),
      topology_(mesh_),
      now_{resolved.setup.region_of, fixed_vertices(scene_, mesh_)},
      held_at_first_(now_.held),
      labels_(distinct(mesh_.labels)),
      surface_(topology_, now_.region_of) {
  const SurfaceMesh& surface = surface_.mesh();
  rest_.resize(3, surface.vertex_count());
  for (Index v = 0; v < surface.vertex_count(); ++v)
    rest_.col(v) = mesh_.points.col(surface.mesh_vertex[std::size_t(v)]).cast<float>();
  skin_ = surface.mesh_vertex;
  std::sort(skin_.begin(), skin_.end());
  skin_.erase(std::unique(skin_.begin(), skin_.end()), skin_.end());
  barycentres_.resize(3, mesh_.tet_count());
  for (Index t = 0; t < mesh_.tet_count(); ++t) {
    barycentres_.col(t) = barycentre(mesh_, t);
    volumes_.push_back(signed_volume(tet_points(mesh_, t)));
  }
}

void Painting::begin() {
  if (is_in_stroke_) return;
  if (past_.size() == most_undone) past_.erase(past_.begin());
  past_.push_back(now_);
  is_in_stroke_ = true;
}

void Painting::paint(const Vec3d& at, double radius, RegionModel model) {
  begin();
  const std::vector<Index> tets = within(barycentres_, all(mesh_.tet_count()), at, radius);
  for (const Index t : tets) now_.region_of[std::size_t(t)] = model;
  follow(tets);
}

void Painting::hold(const Vec3d& at, double radius, bool held) {
  begin();
  for (const Index v : within(mesh_.points, skin_, at, radius)) now_.held[std::size_t(v)] = held ? 1 : 0;
}

void Painting::paint_all(RegionModel model) {
  end_stroke();
  begin();
  std::fill(now_.region_of.begin(), now_.region_of.end(), model);
  follow_all();
  end_stroke();
}

void Painting::use(const std::vector<RegionModel>& region_of) {
  end_stroke();
  begin();
  now_.region_of = region_of;
  follow_all();
  end_stroke();
}

void Painting::undo() {
  end_stroke();
  if (past_.empty()) return;
  now_ = std::move(past_.back());
  past_.pop_back();
  follow_all();
}

void Painting::follow_all() { follow(all(mesh_.tet_count())); }

std::array<double, 3> Painting::shares() const {
  std::array<double, 3> shares{};
  const double whole = std::accumulate(volumes_.begin(), volumes_.end(), 0.0);
  for (std::size_t t = 0; t < volumes_.size(); ++t)
    shares[std::size_t(now_.region_of[t])] += volumes_[t] / whole;
  return shares;
}

// A former label and a model are a label: what selects by former labels can go on doing so.
int Painting::label(Index tet) const {
  const auto place = std::lower_bound(labels_.begin(), labels_.end(), mesh_.labels[std::size_t(tet)]);
  return 1 + 3 * static_cast<int>(place - labels_.begin()) +
         static_cast<int>(now_.region_of[std::size_t(tet)]);
}

TetMesh Painting::mesh() const {
  TetMesh mesh = mesh_;
  for (Index t = 0; t < mesh.tet_count(); ++t) mesh.labels[std::size_t(t)] = label(t);
  return mesh;
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
      for (int model = 0; model < 3; ++model)
        labels.push_back(1 + 3 * static_cast<int>(place - labels_.begin()) + model);
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

Scene Painting::scene(const std::filesystem::path& mesh) const {
  Scene scene = scene_;
  scene.mesh = mesh;
  if (!scene.condensed_cache.empty())
    scene.condensed_cache = std::filesystem::absolute(scene_.file).parent_path() / scene.condensed_cache;
  scene.auto_regions.reset();
  const RegionFrame frame = scene.regions.empty() ? RegionFrame::fixed : scene.regions.front().frame;
  scene.regions.clear();
  for (const RegionModel model : models) {
    std::vector<int> labels;
    for (Index t = 0; t < mesh_.tet_count(); ++t)
      if (now_.region_of[std::size_t(t)] == model) labels.push_back(label(t));
    if (labels.empty()) continue;
    Region region{.name = region_names[std::size_t(model)], .model = model, .where = {}, .pointer = {}};
    if (model == RegionModel::precomputed) region.frame = frame;
    region.where = Selector{SelectLabel{distinct(std::move(labels))}};
    scene.regions.push_back(std::move(region));
  }
  for (Material& material : scene.materials)
    if (material.where) relabel(*material.where);
  for (Boundary& entry : scene.boundary) relabel(entry.where);
  for (Tool& tool : scene.tools)
    if (tool.where) relabel(*tool.where);
  if (now_.held == held_at_first_) return scene;
  std::erase_if(scene.boundary, [](const Boundary& entry) { return entry.kind == Boundary::Kind::fix; });
  SelectVertices vertices;
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (now_.held[std::size_t(v)]) vertices.vertices.push_back(v);
  if (!vertices.vertices.empty())
    scene.boundary.insert(scene.boundary.begin(),
                          Boundary{.where = Selector{std::move(vertices)}, .pointer = {}});
  return scene;
}

std::filesystem::path Painting::save(const std::filesystem::path& folder, const std::string& name) const {
  check_file_name(name);
  const std::filesystem::path file = folder / (name + ".json"), mesh_file = folder / (name + ".vtu");
  write_vtu(mesh_file, mesh());
  io::write_file(file, to_json(scene(mesh_file.filename())));
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
