#include "lobe/region/smoothed_patches.h"

#include <algorithm>
#include <numeric>

#include "lobe/assert.h"
#include "lobe/error.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/region/domain_lanes.h"
#include "lobe/sort_unique.h"

namespace lobe {

template <class Real>
std::vector<typename SmoothedPatches<Real>::Layout::Item> SmoothedPatches<Real>::items_of(
    const std::vector<Index>& edges) const {
  std::vector<typename Layout::Item> items;
  for (Index e : edges) {
    const SmoothedEdge& edge = edges_[e];
    if (!(edge.volume > 0)) continue;
    if (static_cast<Index>(edge.vertices.size()) > patch_vertices)
      throw InputError(
          "edge from vertex " + std::to_string(edge.vertices[0]) + " to " + std::to_string(edge.vertices[1]),
          "its tetrahedra have " + std::to_string(edge.vertices.size()) + " vertices, of at most " +
              std::to_string(patch_vertices) + " that \"element\": \"edge-smoothed\" takes");
    items.push_back({e, edge.vertices, edge.material});
  }
  return items;
}

template <class Real>
void SmoothedPatches<Real>::follow(const Elements& elements, const std::vector<Index>& leave,
                                   const std::vector<Index>& enter, RegionModel model) {
  const std::vector<Index> edges = edges_.follow(elements, leave, enter, model);
  if (edges.empty()) return;
  fibres_ = any_fibre(elements.materials);
  laws_.clear();
  const bool is_finite = strain_ == Strain::finite;
  nodal_pressure_ = is_finite && any_nodal_pressure(elements.materials);
  for (const Elastic& elastic : elements.materials) {
    laws_.push_back(is_finite ? nonlinear_law(elastic, 0, 0) : linear_law(elastic));
    laws_.back().terms.pressure = is_finite && elastic.nodal_lambda() > 0;
  }
  if (nodal_pressure_) {
    pressures_.follow(elements, edges_, edges);
    volume_strain_.resize(std::size_t(edges_.count()));
    pressure_.resize(std::size_t(pressures_.count()));
  }
  layout_.resize(elements.topology.vertex_count(), edges_.count());
  const std::vector<typename Layout::Item> items = items_of(edges);
  const auto entering = layout_.keep(items, [this](Index slot) { return corners_[slot]; });
  std::vector<Index> changed;  // patches
  for (Index e : edges) {
    if (!layout_.must_leave(e)) continue;
    const Index slot = layout_.slot_of(e);
    changed.push_back(slot / Layout::capacity);
    corners_[slot] = corners_[layout_.leave(e, corners_[slot])];
  }
  layout_.enter(entering, elements.points.padded());
  corners_.resize(std::size_t(layout_.patch_count()) * Layout::capacity);
  for (const auto& item : items) {
    const Index slot = layout_.slot_of(item.id), p = slot / Layout::capacity;
    corners_[slot] = layout_.local_corners(p, item.corners);
    changed.push_back(p);
  }
  sort_unique(changed);
  patches_.resize(std::size_t(layout_.patch_count()));
  if (nodal_pressure_) gradients_.resize(patches_.size() * patch_blocks);
  sums_.resize(layout_.patch_count());
  for (Index p : changed) write(p);
}

// Domains of as many vertices stay in the order of their slots, in which neighbours lie far apart
// (patch_layout.cpp).
template <class Real>
void SmoothedPatches<Real>::write(Index p) {
  constexpr Index width = Block::width;
  const Index count = layout_.patch(p).items, first = p * Layout::capacity;
  std::vector<Index> slots(std::size_t(count), 0);
  std::iota(slots.begin(), slots.end(), first);
  std::stable_sort(slots.begin(), slots.end(),
                   [&](Index a, Index b) { return corners_[a].size() < corners_[b].size(); });
  Patch& patch = patches_[p];
  patch = {};
  patch.blocks.resize(std::size_t((count + width - 1) / width));
  if (fibres_) patch.fibres.resize(patch.blocks.size());
  if (nodal_pressure_) patch.node_rows.resize(patch.blocks.size());
  for (Index slot : slots) patch.edges.push_back(layout_.id_of(slot));
  for (Index b = 0; b * width < count; ++b) {
    const Index end = std::min(count, (b + 1) * width);
    Block& block = patch.blocks[b];
    block.vertices = static_cast<Index>(corners_[slots[end - 1]].size());
    block.first = static_cast<Index>(patch.gradients.size());
    patch.gradients.resize(patch.gradients.size() + std::size_t(block.vertices - 1));
    patch.numbers.resize(patch.numbers.size() + std::size_t(block.vertices));
    for (Index i = b * width; i < end; ++i) write_lane(patch, b, int(i - b * width), slots[i]);
  }
}

template <class Real>
void SmoothedPatches<Real>::write_lane(Patch& patch, Index b, int lane, Index slot) const {
  const Index number = layout_.id_of(slot);
  const SmoothedEdge& edge = edges_[number];
  const auto& corners = corners_[slot];
  Block& block = patch.blocks[b];
  block.V[lane] = static_cast<Real>(edge.volume);
  for (Index j = 0; j < block.vertices; ++j) {
    const bool is_there = j < static_cast<Index>(corners.size());
    patch.numbers[block.first + b + j][lane] = corners[is_there ? j : 0];
    for (int d = 0; d < 3 && is_there && j > 0; ++d)
      patch.gradients[block.first + j - 1].b[d][lane] = static_cast<Real>(edge.gradients[j][d]);
  }
  for (int d = 0; d < 3 && fibres_; ++d)
    patch.fibres[b].direction[d][lane] = static_cast<Real>(edge.direction[d]);
  for (int end = 0; end < 2 && nodal_pressure_; ++end)
    patch.node_rows[b].nodes[end][lane] = pressures_.of(number)[end];
}

template <class Real>
SmoothedArrays<Real> SmoothedPatches<Real>::arrays(Index p, const LocalVectors& u) const {
  const Patch& patch = patches_[p];
  const Law<double>& law = laws_[layout_.patch(p).kind];
  return {patch.blocks.data(),
          static_cast<Index>(patch.blocks.size()),
          patch.gradients.data(),
          patch.numbers.data(),
          patch.fibres.data(),
          nodal_pressure_ ? patch.node_rows.data() : nullptr,
          pressure_.data(),
          u.data(),
          law.terms.pressure ? gradients_.data() + std::size_t(p) * patch_blocks : nullptr,
          law.template as<Real>(),
          strain_};
}

// Gradients are kept for what is evaluated next.
template <class Real>
void SmoothedPatches<Real>::find_pressures(const Mat3X<Real>& u, Parallel& parallel) {
  parallel.for_ranges(layout_.patch_count(), sums_.patches_at_once, [&](Index begin, Index end) {
    LocalVectors local;
    std::array<Real, std::size_t(Layout::capacity)> strains;
    for (Index p = begin; p < end; ++p) {
      SmoothedArrays<Real> patch = arrays(p, local);
      if (!patch.law.terms.pressure) continue;
      patch.H = nullptr;
      sums_.gather(layout_, p, u, local);
      kernels_.find_gradients(patch, gradients_.data() + std::size_t(p) * patch_blocks, strains.data());
      for (std::size_t i = 0; i < patches_[p].edges.size(); ++i)
        volume_strain_[patches_[p].edges[i]] = strains[i];
    }
  });
  pressures_.gather(volume_strain_, pressure_, parallel);
}

template <class Real>
void SmoothedPatches<Real>::add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
  if (!any()) return;
  if (nodal_pressure_) find_pressures(u, parallel);
  sums_.add_forces(layout_, u, f, parallel,
                   [&](Index p, const LocalVectors& local, PaddedVector<Real>* sums) {
                     kernels_.add_forces(arrays(p, local), sums);
                   });
}

template <class Real>
double SmoothedPatches<Real>::energy(const Mat3X<Real>& u) {
  using T = Pack<Real>;
  if (!any()) return 0;
  Parallel one_thread;
  if (nodal_pressure_) find_pressures(u, one_thread);
  LocalVectors local;
  double sum = 0;
  for (Index p = 0; p < layout_.patch_count(); ++p) {
    sums_.gather(layout_, p, u, local);
    const SmoothedArrays<Real> patch = arrays(p, local);
    for (Index i = 0; i < layout_.patch(p).items; i += DomainLanes<T>::count) {
      const Index block = i / Block::width, first = i % Block::width;
      const DomainLanes<T> e(patch, block, first);
      const Law<T> law = law_of_domains<T>(patch, patch.law.terms, block, first);
      const T W =
          e.V * (strain_ == Strain::finite ? law_energy_density(law, e.H) : linear_energy_density(law, e.H));
      for (int lane = 0; lane < DomainLanes<T>::count; ++lane) sum += double(Real(W[lane]));  // 0 if empty
    }
  }
  return sum;
}

// ∇u per domain, where find_pressures() has kept it.
template <class Real>
std::vector<Mat3<double>> SmoothedPatches<Real>::kept_gradients() const {
  std::vector<Mat3<double>> of_domain(std::size_t(edges_.count()), Mat3<double>::Zero());
  for (Index p = 0; p < layout_.patch_count(); ++p) {
    if (!laws_[layout_.patch(p).kind].terms.pressure) continue;
    const std::vector<Index>& edges = patches_[p].edges;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto& entries = gradients_[std::size_t(p) * patch_blocks + i / Block::width].entries;
      for (int k = 0; k < 9; ++k) of_domain[edges[i]](k % 3, k / 3) = double(entries[k][i % Block::width]);
    }
  }
  return of_domain;
}

// Two passes compute three entries each, which are added up like forces.
template <class Real>
void SmoothedPatches<Real>::add_diagonal_stiffness(const Mat3X<Real>& at, DiagonalStiffness& K,
                                                   Parallel& parallel) {
  if (!any()) return;
  const Mat3X<Real> rest = Mat3X<Real>::Zero(3, strain_ == Strain::finite ? 0 : at.cols());
  const Mat3X<Real>& u = strain_ == Strain::finite ? at : rest;
  sums_.forget();  // the entries overwrite the stored forces
  if (nodal_pressure_) find_pressures(u, parallel);
  Mat3X<Real> entries(3, layout_.places().vertex_count());  // of the stiffness per vertex [N/m]
  for (const StiffnessPart part : {StiffnessPart::diagonal, StiffnessPart::off_diagonal}) {
    entries.setZero();
    sums_.add_forces(layout_, u, entries, parallel,
                     [&](Index p, const LocalVectors& local, PaddedVector<Real>* sums) {
                       kernels_.add_stiffness(arrays(p, local), part, sums);
                     });
    const std::array<int, 3> rows =
        part == StiffnessPart::diagonal ? std::array{0, 3, 5} : std::array{1, 2, 4};
    for (Index v = 0; v < entries.cols(); ++v)
      for (int i = 0; i < 3; ++i) K(rows[i], v) += double(entries(i, v));
  }
  if (nodal_pressure_) pressures_.add_diagonal_stiffness(edges_, kept_gradients(), K);
}

template <class Real>
std::size_t SmoothedPatches<Real>::bytes() const {
  std::size_t sum = 0;
  const auto of = [](const auto& rows) { return rows.size() * sizeof(rows[0]); };
  for (const Patch& p : patches_)
    sum += of(p.blocks) + of(p.gradients) + of(p.numbers) + of(p.fibres) + of(p.node_rows);
  return sum;
}

template class SmoothedPatches<float>;
template class SmoothedPatches<double>;

}  // namespace lobe
