#include "lobe/region/patch_layout.h"

#include <algorithm>

#include "lobe/mesh/spatial_order.h"

namespace lobe {
namespace {

// By material, then along a Hilbert curve.
std::vector<Index> in_patch_order(const Elements& elements, const std::vector<Index>& tets) {
  Mat3X<double> barycentres(3, Eigen::Index(tets.size()));
  for (std::size_t i = 0; i < tets.size(); ++i)
    barycentres.col(Eigen::Index(i)) = elements.corner_points(tets[i]).rowwise().mean();
  std::vector<Index> order = spatial_order(barycentres);
  for (Index& i : order) i = tets[i];
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return elements.material_of[a] < elements.material_of[b]; });
  return order;
}

// Neighbours in the order of the curve far apart, so that those side by side in a block seldom share a vertex: a sum in
// memory that was just written is slow to be read again.
template <class Visit>
void for_strided(Index begin, Index end, Visit&& visit) {
  constexpr Index lanes = 16;
  const Index stride = (end - begin + lanes - 1) / lanes;
  for (Index row = 0; row < stride; ++row)
    for (Index i = begin + row; i < end; i += stride) visit(i);
}

}  // namespace

std::array<std::uint8_t, 4> PatchLayout::local_corners(Index p, const Eigen::Vector4i& corners) const {
  std::array<std::uint8_t, 4> local;
  for (int c = 0; c < 4; ++c) local[c] = static_cast<std::uint8_t>(local_number(p, corners[c]));
  return local;
}

void PatchLayout::resize(const Topology& topology) {
  slot_of_tet_.resize(std::size_t(topology.tet_count()), -1);
  while (places_.vertex_count() < topology.vertex_count()) places_.add_vertex();
}

void PatchLayout::enter(const Elements& elements, const std::vector<Index>& tets) {
  if (static_cast<Index>(tets.size()) > patch_tets / 2) return fill_new_patches(elements, tets);
  for (Index t : tets) put(patch_for(elements, t), t, elements.topology.corners(t));
}

void PatchLayout::fill_new_patches(const Elements& elements, const std::vector<Index>& tets) {
  const std::vector<Index> order = in_patch_order(elements, tets);
  const Index count = static_cast<Index>(order.size()), first_patch = patch_count();
  const std::size_t patches = patches_.size() + order.size() * 17 / (16 * patch_tets) + 4;
  vertex_.reserve(patches * patch_vertices);
  uses_.reserve(patches * patch_vertices);
  tet_of_slot_.reserve(patches * patch_tets);
  std::vector<Index> known_to(std::size_t(elements.topology.vertex_count()), -1);  // the last patch
  std::vector<Index> ends;
  for (Index i = 0; i < count; ends.push_back(i)) {
    const std::uint16_t material = elements.material_of[order[i]];
    const Index p = append_patch(material), end = std::min(count, i + patch_tets);
    for (; i < end && elements.material_of[order[i]] == material; ++i) {
      const Eigen::Vector4i corners = elements.topology.corners(order[i]);
      const auto missing =
          std::count_if(corners.begin(), corners.end(), [&](Index v) { return known_to[v] != p; });
      if (patches_[p].vertices + missing > patch_vertices) break;
      for (Index v : corners) {
        if (known_to[v] == p) continue;
        known_to[v] = p;
        vertex_[p * patch_vertices + patches_[p].vertices++] = v;
      }
    }
  }
  list_places(first_patch, elements.topology.vertex_count());
  for (Index i = 0, p = first_patch; p < patch_count(); i = ends[p++ - first_patch])
    for_strided(i, ends[p - first_patch],
                [&](Index at) { put(p, order[at], elements.topology.corners(order[at])); });
}

void PatchLayout::list_places(Index first_patch, Index vertex_count) {
  const auto for_places = [&](auto&& visit) {
    for (Index p = first_patch; p < patch_count(); ++p)
      for (Index n = 0; n < patches_[p].vertices; ++n) visit(p * patch_vertices + n);
  };
  if (first_patch == 0) {
    std::vector<Index> lengths(std::size_t(vertex_count), 0);
    for_places([&](Index place) { ++lengths[vertex_[place]]; });
    places_ = VertexLists<Index>(lengths);
  }
  for_places([&](Index place) { places_.append(vertex_[place], place); });
}

Index PatchLayout::leave(Index tet, const std::array<std::uint8_t, 4>& local_corners) {
  const Index slot = slot_of_tet_[tet], p = slot / patch_tets;
  Patch& patch = patches_[p];
  for (std::uint8_t n : local_corners) {
    const Index place = p * patch_vertices + n;
    if (--uses_[place] > 0) continue;
    places_.erase_value(vertex_[place], place);
    ++patch.free;
  }
  const Index last = p * patch_tets + --patch.tets;
  tet_of_slot_[slot] = tet_of_slot_[last];
  slot_of_tet_[tet_of_slot_[slot]] = slot;
  slot_of_tet_[tet] = -1;
  --tet_count_;
  if (patch.tets == 0) {
    patch.vertices = patch.free = 0;
    empty_.push_back(p);
  }
  return last;
}

// Of the patches around it, that which knows most of its vertices.
Index PatchLayout::patch_for(const Elements& elements, Index tet) {
  const Eigen::Vector4i corners = elements.topology.corners(tet);
  const std::uint16_t material = elements.material_of[tet];
  Index best = -1;
  int most = 0;
  for (Index v : corners)
    for (Index place : places_[v]) {
      const Index p = place / patch_vertices;
      const auto known =
          std::count_if(corners.begin(), corners.end(), [&](Index w) { return local_number(p, w) >= 0; });
      if (known <= most || !has_room(p, material, corners)) continue;
      best = p;
      most = static_cast<int>(known);
    }
  if (best >= 0) return best;
  return open_ >= 0 && has_room(open_, material, corners) ? open_ : open_patch(material);
}

bool PatchLayout::has_room(Index p, std::uint16_t material, const Eigen::Vector4i& corners) const {
  const Patch& patch = patches_[p];
  if (patch.material != material || patch.tets == patch_tets) return false;
  const auto missing =
      std::count_if(corners.begin(), corners.end(), [&](Index v) { return local_number(p, v) < 0; });
  return patch.vertices - patch.free + missing <= patch_vertices;
}

Index PatchLayout::append_patch(std::uint16_t material) {
  const Index p = patch_count();
  patches_.push_back({0, 0, 0, material});
  vertex_.resize(patches_.size() * patch_vertices, 0);
  uses_.resize(patches_.size() * patch_vertices, 0);
  tet_of_slot_.resize(patches_.size() * patch_tets, -1);
  return p;
}

Index PatchLayout::open_patch(std::uint16_t material) {
  while (!empty_.empty() && patches_[empty_.back()].tets > 0) empty_.pop_back();
  if (empty_.empty()) return open_ = append_patch(material);
  open_ = empty_.back();
  empty_.pop_back();
  patches_[open_].material = material;
  return open_;
}

Index PatchLayout::local_number(Index p, Index vertex) const {
  for (Index place : places_[vertex])
    if (place / patch_vertices == p) return place % patch_vertices;
  return -1;
}

Index PatchLayout::number_vertex(Index p, Index vertex) {
  Patch& patch = patches_[p];
  Index place = p * patch_vertices;
  if (patch.free > 0) {
    while (uses_[place] > 0) ++place;
    --patch.free;
  } else {
    place += patch.vertices++;
  }
  vertex_[place] = vertex;
  places_.append(vertex, place);
  return place % patch_vertices;
}

void PatchLayout::put(Index p, Index tet, const Eigen::Vector4i& corners) {
  for (Index v : corners) {
    const Index known = local_number(p, v), n = known >= 0 ? known : number_vertex(p, v);
    ++uses_[p * patch_vertices + n];
  }
  const Index slot = p * patch_tets + patches_[p].tets++;
  tet_of_slot_[slot] = tet;
  slot_of_tet_[tet] = slot;
  ++tet_count_;
}

}  // namespace lobe
