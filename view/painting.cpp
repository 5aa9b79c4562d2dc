#include "painting.h"

#include <algorithm>
#include <numeric>

#include "lobe/error.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/select.h"

namespace lobe::view {
namespace {

constexpr std::size_t most_undone = 100;
constexpr std::size_t most_materials = 8;

// Those of the columns `of` of points that are at most `radius` away, or the nearest one if there is none.
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

double young_of(const Material& material) {
  if (material.transverse) return material.transverse->young_across;
  return young_modulus(material.lame_lambda, material.lame_mu);
}

Painting::Painting(Scene scene, const Resolved& resolved)
    : scene_(std::move(scene)),
      cell_(resolved.setup.lattice_cell),
      mesh_(resolved.setup.mesh),
      topology_(mesh_),
      now_{resolved.setup.region_of,
           {resolved.setup.material_of.begin(), resolved.setup.material_of.end()},
           fixed_vertices(scene_, mesh_),
           resolved.setup.precomputed_frame},
      held_at_first_(now_.held),
      material_at_first_(now_.material_of),
      labels_(distinct(mesh_.labels)),
      surface_(topology_, TetTags(now_.region_of, mesh_.bodies)) {
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

void Painting::paint_material(const Vec3d& at, double radius, int material) {
  if (material < 0 || std::size_t(material) >= materials().size())
    throw InputError("/material", "there are " + std::to_string(materials().size()) + ", counted from 0");
  begin();
  for (const Index t : within(barycentres_, all(mesh_.tet_count()), at, radius))
    now_.material_of[std::size_t(t)] = material;
}

int Painting::add_material(const std::string& name, double young) {
  constexpr double softest = 1, stiffest = 1e9;  // [Pa]
  if (!(young >= softest && young <= stiffest)) throw InputError("/young", "must be from 1 to 1e9 Pa");
  if (name.empty()) throw InputError("/name", "a material needs a name");
  for (const Material& material : materials())
    if (material.name == name) throw InputError("/name", "there is a material \"" + name + "\" already");
  if (materials().size() >= most_materials)
    throw InputError("/name", "8 materials are as many as can be painted");
  Material material = materials().front();
  const double factor = young / young_of(material);
  material.name = name;
  material.lame_lambda *= factor;
  material.lame_mu *= factor;
  if (TransverseConstants* const fibrous = material.transverse ? &*material.transverse : nullptr)
    for (double* modulus : {&fibrous->young_along, &fibrous->young_across, &fibrous->shear_along})
      *modulus *= factor;
  scene_.materials.push_back(material);
  return static_cast<int>(scene_.materials.size()) - 1;
}

// Vertices that are set free are free below the skin, too.
void Painting::hold(const Vec3d& at, double radius, bool held) {
  begin();
  const std::vector<Index> reached = held ? within(mesh_.points, skin_, at, radius)
                                          : within(mesh_.points, all(mesh_.vertex_count()), at, radius);
  for (const Index v : reached) now_.held[std::size_t(v)] = held ? 1 : 0;
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

void Painting::set_frame(RegionFrame frame) {
  end_stroke();
  begin();
  now_.frame = frame;
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

std::vector<std::vector<Index>> Painting::precomputed_parts() const {
  const auto is_precomputed = [&](Index t) {
    return now_.region_of[std::size_t(t)] == RegionModel::precomputed;
  };
  std::vector<std::vector<Index>> parts;
  std::vector<char> found(std::size_t(mesh_.tet_count()), 0);
  for (Index first = 0; first < mesh_.tet_count(); ++first) {
    if (found[std::size_t(first)] || !is_precomputed(first)) continue;
    std::vector<Index>& part = parts.emplace_back(1, first);
    found[std::size_t(first)] = 1;
    for (std::size_t at = 0; at < part.size(); ++at)
      for (int face = 0; face < 4; ++face) {
        const Index other = topology_.neighbour(part[at], face);
        if (other < 0 || found[std::size_t(other)] || !is_precomputed(other)) continue;
        found[std::size_t(other)] = 1;
        part.push_back(other);
      }
  }
  return parts;
}

std::vector<Index> Painting::unheld() const {
  const std::vector<std::vector<Index>> parts = precomputed_parts();
  const auto largest = std::max_element(parts.begin(), parts.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
  const auto is_held = [&](Index t) {
    const Eigen::Vector4i corners = topology_.corners(t);
    return std::any_of(corners.begin(), corners.end(),
                       [&](Index v) { return now_.held[std::size_t(v)] != 0; });
  };
  std::vector<Index> tets;
  for (auto part = parts.begin(); part != parts.end(); ++part)
    if (now_.frame == RegionFrame::corotated ? part != largest
                                             : std::none_of(part->begin(), part->end(), is_held))
      tets.insert(tets.end(), part->begin(), part->end());
  return tets;
}

bool Painting::can_turn() const {
  const std::vector<std::vector<Index>> parts = precomputed_parts();
  return parts.size() == 1 && Index(parts[0].size()) < mesh_.tet_count();
}

double Painting::share_of(const std::vector<Index>& tets) const {
  double sum = 0;
  for (const Index t : tets) sum += volumes_[std::size_t(t)];
  return sum / std::accumulate(volumes_.begin(), volumes_.end(), 0.0);
}

std::vector<double> Painting::material_shares() const {
  std::vector<double> shares(materials().size(), 0);
  const double whole = std::accumulate(volumes_.begin(), volumes_.end(), 0.0);
  for (std::size_t t = 0; t < volumes_.size(); ++t)
    shares[std::size_t(now_.material_of[t])] += volumes_[t] / whole;
  return shares;
}

std::array<double, region_model_names.size()> Painting::shares() const {
  std::array<double, region_model_names.size()> shares{};
  const double whole = std::accumulate(volumes_.begin(), volumes_.end(), 0.0);
  for (std::size_t t = 0; t < volumes_.size(); ++t)
    shares[std::size_t(now_.region_of[t])] += volumes_[t] / whole;
  return shares;
}

}  // namespace lobe::view
