#include "lobe/region/patches.h"

#include <algorithm>

#include "lobe/assert.h"
#include "lobe/fem/law_of.h"
#include "lobe/region/compiled_terms.h"

namespace lobe {

template <class Real>
void Patches<Real>::follow(const Elements& elements, const std::vector<Index>& leave,
                           const std::vector<Index>& enter, RegionModel model, const TetPairs& copied) {
  set_laws(elements, model);
  const std::vector<Layout::Item> items = items_of(model, elements, paces_, enter);
  if (items.empty() && tet_count() == 0) return;  // without tetrahedra no memory is needed
  layout_.resize(elements.topology.vertex_count(), elements.topology.tet_count());
  const Histories histories = histories_of(leave);
  const auto entering = layout_.keep(items, [this](Index slot) { return corners_in(slot); });
  for (Index t : leave)
    if (layout_.must_leave(t)) remove(t);
  if (nodal_pressure_) nodes_.follow(elements, leave, enter);
  layout_.enter(entering, elements.points.padded());
  const std::size_t patches = std::size_t(layout_.patch_count());
  resize_with_room(blocks_, patches * patch_blocks);
  if (fibres_) resize_with_room(fibre_blocks_, patches * patch_blocks);
  sums_.resize(layout_.patch_count());
  if (nodal_pressure_) {
    resize_with_room(pressure_blocks_, patches * patch_blocks);
    volume_strain_.resize(std::size_t(elements.topology.tet_count()));
    pressure_.resize(std::size_t(nodes_.count()));
    slopes_.resize(3, 4 * Eigen::Index(elements.topology.tet_count()));
  }
  for (const Layout::Item& item : items) write(elements, item);
  if (viscosity_.any()) take_histories(items, histories, copied);
}

template <class Real>
void Patches<Real>::set_laws(const Elements& elements, RegionModel model) {
  laws_.clear();
  for (const Elastic& elastic : elements.materials) laws_.push_back(unsmoothed_law(elements, elastic, model));
  const auto is_averaged = [&](std::size_t material) {  // or would be, if its share were not 0
    return laws_[material].terms.solid != MaterialLaw::corotational &&
           !elements.materials[material].is_smoothed();
  };
  viscosity_.set_materials(elements.materials, [](const Elastic& e) { return !e.is_smoothed(); });
  nodal_pressure_ = fibres_ = false;
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    nodal_pressure_ = nodal_pressure_ || (is_averaged(i) && elements.materials[i].nodal_lambda() > 0);
    fibres_ = fibres_ || laws_[i].terms.has_direction();
  }
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    laws_[i].terms.pressure = nodal_pressure_ && is_averaged(i);
    lobe_assert(laws_[i].terms.solid == MaterialLaw::none || is_covered(laws_[i].terms),
                "no kernel is compiled for the law of a material");
  }
}

template <class Real>
void Patches<Real>::write(const Elements& elements, const Layout::Item& item) {
  lobe_assert(item.kind < laws_.size(), "patches: a tetrahedron of a material that there is not");
  const Index slot = layout_.slot_of(item.id);
  Block& block = blocks_[slot / width];
  const int lane = slot % width;
  const Shape s = elements.shape_of(item.id);
  for (int i = 0; i < 9; ++i) block.alpha[i][lane] = static_cast<Real>(s.gradients(i % 3, 1 + i / 3));
  block.V[lane] = static_cast<Real>(s.volume);
  const auto corners = layout_.local_corners(slot / Layout::capacity, item.corners);
  for (int c = 0; c < 4; ++c) block.corners[c][lane] = corners[c];
  const Vec3d direction = elements.fibre_of(item.id);
  for (int i = 0; i < 3 && fibres_; ++i)
    fibre_blocks_[slot / width].direction[i][lane] = static_cast<Real>(direction[i]);
  if (!nodal_pressure_) return;
  const Eigen::Vector4i nodes = nodes_.of(item.id);
  for (int c = 0; c < 4; ++c) pressure_blocks_[slot / width].nodes[c][lane] = nodes[c];
}

template <class Real>
PatchLayout<4>::LocalCorners Patches<Real>::corners_in(Index slot) const {
  const auto& corners = blocks_[slot / width].corners;
  const int lane = slot % width;
  return {corners[0][lane], corners[1][lane], corners[2][lane], corners[3][lane]};
}

template <class Real>
void Patches<Real>::remove(Index tet) {
  const Index slot = layout_.slot_of(tet);
  const Index last = layout_.leave(tet, corners_in(slot));
  move(last, slot);
  clear(last);
}

template <class Real>
void Patches<Real>::move(Index from, Index to) {
  const Index p = to / Layout::capacity;
  if (viscosity_.has(p))
    viscosity_.set(p, to % Layout::capacity, viscosity_.strains(p, from % Layout::capacity));
  const int a = from % width, b = to % width;
  const Block& source = blocks_[from / width];
  Block& target = blocks_[to / width];
  for (int i = 0; i < 9; ++i) target.alpha[i][b] = source.alpha[i][a];
  target.V[b] = source.V[a];
  for (int c = 0; c < 4; ++c) target.corners[c][b] = source.corners[c][a];
  for (int i = 0; i < 3 && fibres_; ++i)
    fibre_blocks_[to / width].direction[i][b] = fibre_blocks_[from / width].direction[i][a];
  if (!nodal_pressure_) return;
  for (int c = 0; c < 4; ++c)
    pressure_blocks_[to / width].nodes[c][b] = pressure_blocks_[from / width].nodes[c][a];
}

template <class Real>
void Patches<Real>::clear(Index slot) {
  Block& block = blocks_[slot / width];
  const int lane = slot % width;
  for (auto& row : block.alpha) row[lane] = 0;
  block.V[lane] = 0;
  for (auto& row : block.corners) row[lane] = 0;
  for (int i = 0; i < 3 && fibres_; ++i) fibre_blocks_[slot / width].direction[i][lane] = 0;
  // Kernels go on with it: what is left there would fall for ever, to the slow smallest numbers.
  if (const Index p = slot / Layout::capacity; viscosity_.has(p))
    viscosity_.set(p, slot % Layout::capacity, typename Viscosity<Real>::Strains{});
  if (!nodal_pressure_) return;
  for (auto& row : pressure_blocks_[slot / width].nodes) row[lane] = PressureNodes::none;
}

// ---- The strains of dashpots

// visit(tetrahedron, patch, its lane), by the numbers of tetrahedra.
template <class Real>
template <class Visit>
void Patches<Real>::for_viscous(Visit&& visit) const {
  for (Index t = 0; t < layout_.id_count(); ++t)
    if (const Index slot = layout_.slot_of(t); slot >= 0 && viscosity_.has(slot / Layout::capacity))
      visit(t, slot / Layout::capacity, slot % Layout::capacity);
}

template <class Real>
typename Patches<Real>::Histories Patches<Real>::histories_of(const std::vector<Index>& tets) const {
  Histories histories;
  for (Index t : tets)
    if (const Index slot = layout_.slot_of(t); slot >= 0 && viscosity_.has(slot / Layout::capacity))
      histories[t] = viscosity_.strains(slot / Layout::capacity, slot % Layout::capacity);
  return histories;
}

template <class Real>
void Patches<Real>::take_histories(const std::vector<Layout::Item>& items, const Histories& histories,
                                   const TetPairs& copied) {
  const typename Viscosity<Real>::Strains no_strains{};
  std::unordered_map<Index, Index> source;
  for (const auto& [tet, copy] : copied) source[copy] = tet;
  for (const Layout::Item& item : items) {
    const Index slot = layout_.slot_of(item.id), p = slot / Layout::capacity;
    viscosity_.fit(p, item.kind, std::size_t(patch_blocks));
    if (!viscosity_.has(p)) continue;
    const auto copy = source.find(item.id);
    const auto known = histories.find(copy == source.end() ? item.id : copy->second);
    const bool has_history = known != histories.end();
    viscosity_.set(p, slot % Layout::capacity, has_history ? known->second : no_strains);
    if (!has_history) without_history_.push_back(item.id);
  }
}

template <class Real>
void Patches<Real>::relax(const Elements& elements, const Mat3X<Real>& u, bool all) {
  if (all) for_viscous([&](Index t, Index, Index) { without_history_.push_back(t); });
  for (Index t : without_history_)
    if (const Index slot = layout_.slot_of(t); slot >= 0)
      viscosity_.set(slot / Layout::capacity, slot % Layout::capacity, green_strain_of(elements, t, u));
  without_history_.clear();
}

template <class Real>
void Patches<Real>::save(std::vector<Real>& strains) const {
  for_viscous([&](Index, Index p, Index lane) { viscosity_.save(p, lane, strains); });
}

template <class Real>
bool Patches<Real>::load(std::span<const Real>& strains) {
  bool fits = true;
  for_viscous([&](Index, Index p, Index lane) { fits = fits && viscosity_.load(p, lane, strains); });
  return fits;
}

template class Patches<float>;
template class Patches<double>;

}  // namespace lobe
