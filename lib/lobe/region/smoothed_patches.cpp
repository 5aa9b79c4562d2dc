#include "lobe/region/smoothed_patches.h"

#include <algorithm>
#include <tuple>

#include "lobe/assert.h"
#include "lobe/error.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/region/domain_lanes.h"
#include "lobe/region/viscous_lanes.h"
#include "lobe/sort_unique.h"

namespace lobe {

namespace {

std::string edge_name(const SmoothedEdge& edge) {
  return "edge from vertex " + std::to_string(edge.vertices[0]) + " to " + std::to_string(edge.vertices[1]);
}

}  // namespace

template <class Real>
std::vector<typename SmoothedPatches<Real>::Layout::Item> SmoothedPatches<Real>::items_of(
    const Elements& elements, const std::vector<Index>& edges) const {
  std::vector<typename Layout::Item> items;
  for (Index e : edges) {
    const SmoothedEdge& edge = edges_[e];
    if (!(edge.volume > 0)) continue;
    if (static_cast<Index>(edge.vertices.size()) > patch_vertices)
      throw InputError(edge_name(edge), "its tetrahedra have " + std::to_string(edge.vertices.size()) +
                                            " vertices, of at most " + std::to_string(patch_vertices) +
                                            " that \"element\": \"edge-smoothed\" takes");
    items.push_back({e, edge.vertices, edge.material, paces_.of(elements.topology, edge.vertices)});
  }
  return items;
}

template <class Real>
void SmoothedPatches<Real>::follow(const Elements& elements, const std::vector<Index>& leave,
                                   const std::vector<Index>& enter, RegionModel model,
                                   const TetPairs& copied) {
  SmoothedHistories<Real> histories;
  if (viscosity_.any()) histories.keep_domains(edges_, leave);
  const std::vector<Index> edges = edges_.follow(elements, leave, enter, model);
  if (edges.empty()) return;
  set_laws(elements, model);
  if (has_tets_) owners_.follow(edges_, leave, enter);
  if (nodal_pressure_) {
    pressures_.follow(elements, edges_, edges);
    volume_strain_.resize(std::size_t(edges_.count()));
    pressure_.resize(std::size_t(pressures_.count()));
  }
  layout_.resize(elements.topology.vertex_count(), edges_.count());
  const std::vector<typename Layout::Item> items = items_of(elements, edges);
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
  for (Index p : changed) histories.keep(viscosity_, p, patches_[p].edges);
  if (viscosity_.any()) histories.inherit(edges_, enter, copied);
  for (Index p : changed) {
    write(elements, p);
    if (viscosity_.any()) give_histories(p, histories);
  }
}

template <class Real>
void SmoothedPatches<Real>::give_histories(Index p, const SmoothedHistories<Real>& histories) {
  viscosity_.fit(p, layout_.patch(p).kind, patches_[p].blocks.size());
  if (!viscosity_.has(p)) return;
  const std::vector<Index> without = histories.give(viscosity_, p, patches_[p].edges);
  without_history_.insert(without_history_.end(), without.begin(), without.end());
  const auto lanes = static_cast<Index>(patches_[p].blocks.size() * Block::width);
  for (Index lane = static_cast<Index>(patches_[p].edges.size()); lane < lanes; ++lane)  // as in Patches
    viscosity_.set(p, lane, typename Viscosity<Real>::Strains{});
}

// Volume term and guard are those of tetrahedra: their moduli are here, and not their terms.
template <class Real>
void SmoothedPatches<Real>::set_laws(const Elements& elements, RegionModel model) {
  fibres_ = any_fibre(elements.materials);
  laws_.clear();
  has_tets_ = nodal_pressure_ = false;
  viscosity_.set_materials(elements.materials, [&](const Elastic& elastic) {
    return elastic.is_smoothed() && strain_ == Strain::finite;
  });
  for (const Elastic& elastic : elements.materials) {
    Law<double>& law = laws_.emplace_back(linear_law(elastic));
    if (strain_ == Strain::small) continue;
    law = model == RegionModel::corotational
              ? corotational_law(elastic)
              : nonlinear_law(elastic, elements.volume_penalty, elements.guard_below);
    has_tets_ = has_tets_ || law.terms.volume || law.terms.guard;
    law.terms.volume = law.terms.guard = false;
    law.terms.pressure = model != RegionModel::corotational && elastic.nodal_lambda() > 0;
    nodal_pressure_ = nodal_pressure_ || law.terms.pressure;
  }
}

// Domains without tetrahedra come first, then those with; either by the number of their vertices. Those of as
// many stay in the order of their slots, in which neighbours lie far apart (patch_layout.cpp).
template <class Real>
std::vector<typename SmoothedPatches<Real>::Domain> SmoothedPatches<Real>::domains_in(
    const Elements& elements, Index p) const {
  std::vector<Domain> domains(std::size_t(layout_.patch(p).items));
  Index slot = p * Layout::capacity;
  for (Domain& domain : domains) {
    domain.slot = slot++;
    const Index e = layout_.id_of(domain.slot);
    find_tet_chain(elements.topology, edges_[e], owners_.of(e), domain.chain);
    if (domain.chain.order.size() > std::size_t(domain_rows))
      throw InputError(edge_name(edges_[e]), "too many copies of tetrahedra share it");
  }
  const auto rank = [](const Domain& domain) {
    return std::tuple(!domain.chain.tets.empty(), domain.chain.order.size(), domain.chain.tets.size());
  };
  std::stable_sort(domains.begin(), domains.end(),
                   [&](const Domain& a, const Domain& b) { return rank(a) < rank(b); });
  return domains;
}

template <class Real>
void SmoothedPatches<Real>::write(const Elements& elements, Index p) {
  constexpr Index width = Block::width;
  const std::vector<Domain> domains = domains_in(elements, p);
  const Index count = static_cast<Index>(domains.size());
  Patch& patch = patches_[p];
  patch = {};
  patch.blocks.resize(std::size_t((count + width - 1) / width));
  if (fibres_) patch.fibres.resize(patch.blocks.size());
  if (nodal_pressure_) patch.node_rows.resize(patch.blocks.size());
  for (const Domain& domain : domains) patch.edges.push_back(layout_.id_of(domain.slot));
  for (Index b = 0; b * width < count; ++b) {
    const Index end = std::min(count, (b + 1) * width);
    Block& block = patch.blocks[b];
    for (Index i = b * width; i < end; ++i) {
      block.vertices = std::max(block.vertices, static_cast<Index>(domains[i].chain.order.size()));
      block.places = std::max(block.places, static_cast<Index>(domains[i].chain.tets.size()));
    }
    block.first = static_cast<Index>(patch.gradients.size());
    block.chain = static_cast<Index>(patch.chains.size());
    patch.gradients.resize(patch.gradients.size() + std::size_t(block.vertices - 1));
    patch.numbers.resize(patch.numbers.size() + std::size_t(block.vertices));
    if (block.places > 0) patch.chains.resize(patch.chains.size() + std::size_t(block.places + 2));
    for (Index i = b * width; i < end; ++i) {
      write_lane(patch, b, int(i - b * width), domains[i]);
      write_chain(elements, patch, b, int(i - b * width), domains[i]);
    }
  }
}

// A vertex that is there again has its gradient once.
template <class Real>
void SmoothedPatches<Real>::write_lane(Patch& patch, Index b, int lane, const Domain& domain) const {
  const Index number = layout_.id_of(domain.slot);
  const SmoothedEdge& edge = edges_[number];
  const auto& corners = corners_[domain.slot];
  const std::vector<std::uint8_t>& order = domain.chain.order;
  Block& block = patch.blocks[b];
  block.V[lane] = static_cast<Real>(edge.volume);
  for (std::size_t j = 0; j < std::size_t(block.vertices); ++j) {
    const bool is_there = j < order.size();
    patch.numbers[block.first + b + j][lane] = PaddedPlace::of(corners[is_there ? order[j] : 0]);
    const bool is_new =
        is_there && std::find(order.begin(), order.begin() + j, order[j]) == order.begin() + j;
    for (int d = 0; d < 3 && is_new && j > 0; ++d)
      patch.gradients[block.first + j - 1].b[d][lane] = static_cast<Real>(edge.gradients[order[j]][d]);
  }
  for (int d = 0; d < 3 && fibres_; ++d)
    patch.fibres[b].direction[d][lane] = static_cast<Real>(edge.direction[d]);
  for (int end = 0; end < 2 && nodal_pressure_; ++end)
    patch.node_rows[b].nodes[end][lane] = pressures_.of(number)[end];
}

template <class Real>
void SmoothedPatches<Real>::write_chain(const Elements& elements, Patch& patch, Index b, int lane,
                                        const Domain& domain) const {
  const SmoothedEdge& edge = edges_[layout_.id_of(domain.slot)];
  const TetChain& chain = domain.chain;
  if (chain.tets.empty()) return;
  const auto from_first = [&](std::size_t j) -> Vec3<Real> {
    const Index v = edge.vertices[chain.order[j]];
    return (elements.points.col(v) - elements.points.col(edge.vertices[0])).template cast<Real>();
  };
  ChainRow<Real>* rows = &patch.chains[patch.blocks[b].chain];
  for (std::size_t j = 1; j < chain.tets.size() + 3; ++j) {
    const Vec3<Real> X = from_first(j);
    for (int d = 0; d < 3; ++d) rows[j - 1].X[d][lane] = X[d];
    const Index tet = j < 3 ? -1 : chain.tets[j - 3];
    if (tet < 0) continue;
    rows[j - 1].six_V[lane] = static_cast<Real>(6 * elements.volume(tet));
    rows[j - 1].per_six_V[lane] = static_cast<Real>(elements.share_of(tet) / (6 * elements.volume(tet)));
  }
}

template <class Real>
SmoothedArrays<Real> SmoothedPatches<Real>::arrays(Index p, const LocalVectors& u) const {
  const Patch& patch = patches_[p];
  const Law<double>& law = laws_[layout_.patch(p).kind];
  return {patch.blocks.data(),
          static_cast<Index>(patch.blocks.size()),
          patch.gradients.data(),
          patch.numbers.data(),
          patch.chains.data(),
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
                     const std::uint16_t kind = layout_.patch(p).kind;
                     if (viscosity_.terms(kind) == 0) return kernels_.add_forces(arrays(p, local), sums);
                     viscous_kernels_.add_forces(arrays(p, local), viscosity_.arrays(p, kind), sums);
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
      T W = strain_ == Strain::finite ? law_energy_density(law, e.H) : linear_energy_density(law, e.H);
      if (const std::uint16_t kind = layout_.patch(p).kind; viscosity_.terms(kind) > 0)
        W += branch_energy(viscosity_.arrays(p, kind), block, first, green_strain(e.H));
      W *= e.V;
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
    sums_.add_forces(
        layout_, u, entries, parallel, [&](Index p, const LocalVectors& local, PaddedVector<Real>* sums) {
          const std::uint16_t kind = layout_.patch(p).kind;
          kernels_.add_stiffness(arrays(p, local), part, sums);
          if (viscosity_.terms(kind) > 0)
            viscous_kernels_.add_stiffness(arrays(p, local), viscosity_.arrays(p, kind), part, sums);
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
    sum += of(p.blocks) + of(p.gradients) + of(p.numbers) + of(p.chains) + of(p.fibres) + of(p.node_rows);
  return sum;
}

// ---- The strains of dashpots

// visit(domain, patch, its lane), by the numbers of domains.
template <class Real>
template <class Visit>
void SmoothedPatches<Real>::for_viscous(Visit&& visit) const {
  struct Place {
    Index p, lane;
  };
  std::vector<Place> places(std::size_t(edges_.count()), Place{-1, 0});
  for (Index p = 0; p < layout_.patch_count(); ++p)
    for (std::size_t i = 0; i < patches_[p].edges.size() && viscosity_.has(p); ++i)
      places[patches_[p].edges[i]] = {p, static_cast<Index>(i)};
  for (Index d = 0; d < edges_.count(); ++d)
    if (places[d].p >= 0) visit(d, places[d].p, places[d].lane);
}

template <class Real>
void SmoothedPatches<Real>::relax(const Elements&, const Mat3X<Real>& u, bool all) {
  if (without_history_.empty() && !(all && viscosity_.any())) return;
  std::vector<bool> is_new(std::size_t(edges_.count()), all);
  for (Index d : without_history_) is_new[d] = true;
  for_viscous([&](Index d, Index p, Index lane) {
    if (is_new[d]) viscosity_.set(p, lane, green_strain(displacement_gradient(edges_[d], u)));
  });
  without_history_.clear();
}

template <class Real>
void SmoothedPatches<Real>::save(std::vector<Real>& strains) const {
  if (!viscosity_.any()) return;
  for_viscous([&](Index, Index p, Index lane) { viscosity_.save(p, lane, strains); });
}

template <class Real>
bool SmoothedPatches<Real>::load(std::span<const Real>& strains) {
  if (!viscosity_.any()) return true;
  bool fits = true;
  for_viscous([&](Index, Index p, Index lane) { fits = fits && viscosity_.load(p, lane, strains); });
  return fits;
}

template class SmoothedPatches<float>;
template class SmoothedPatches<double>;

}  // namespace lobe
