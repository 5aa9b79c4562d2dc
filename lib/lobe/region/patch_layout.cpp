#include "lobe/region/patch_layout.h"

#include <algorithm>
#include <utility>

#include "lobe/assert.h"
#include "lobe/mesh/spatial_order.h"

namespace lobe {
namespace {

// Sorts items by pace and kind, then along a Hilbert curve.
template <class Item>
std::vector<Item> in_patch_order(const std::vector<Item>& items, const Mat3X<double>& points) {
  Mat3X<double> barycentres(3, Eigen::Index(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i)
    barycentres.col(Eigen::Index(i)) = points(Eigen::all, items[i].corners).rowwise().mean();
  std::vector<Item> sorted;
  sorted.reserve(items.size());
  for (Index i : spatial_order(barycentres)) sorted.push_back(items[i]);
  const auto by_kind = [](const Item& a, const Item& b) {
    return std::pair(a.pace, a.kind) < std::pair(b.pace, b.kind);
  };
  if (!std::is_sorted(sorted.begin(), sorted.end(), by_kind))
    std::stable_sort(sorted.begin(), sorted.end(), by_kind);
  return sorted;
}

// Puts neighbours in the order of the curve far apart, so that consecutive items of a block seldom share a
// vertex. A sum in memory that was just written is slow to read again.
template <class Visit>
void for_strided(Index begin, Index end, Visit&& visit) {
  constexpr Index lanes = 16;
  const Index stride = (end - begin + lanes - 1) / lanes;
  for (Index row = 0; row < stride; ++row)
    for (Index i = begin + row; i < end; i += stride) visit(i);
}

}  // namespace

template <int n>
typename PatchLayout<n>::LocalCorners PatchLayout<n>::local_corners(Index p, const Corners& corners) const {
  LocalCorners local{};
  if constexpr (n == any_number) local.resize(corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Index number = local_number(p, corners[c]);
    lobe_assert(number >= 0, "patches: a corner that the item's patch has not");
    local[c] = static_cast<std::uint8_t>(number);
  }
  return local;
}

template <int n>
void PatchLayout<n>::resize(Index vertex_count, Index id_count) {
  slot_of_.resize(std::size_t(id_count), -1);
  while (places_.vertex_count() < vertex_count) places_.add_vertex();
  is_used_.resize(std::size_t(vertex_count), false);
}

template <int n>
void PatchLayout<n>::enter(const std::vector<Item>& items, const Mat3X<double>& points) {
  if (static_cast<Index>(items.size()) > capacity / 2) return fill_new_patches(items, points);
  for (const Item& item : items) put(patch_for(item), item);
}

template <int n>
void PatchLayout<n>::fill_new_patches(const std::vector<Item>& items, const Mat3X<double>& points) {
  const std::vector<Item> order = in_patch_order(items, points);
  const Index count = static_cast<Index>(order.size()), first_patch = patch_count();
  if (first_patch == 0) {
    const std::size_t patches = order.size() * 17 / (16 * capacity) + 4;
    vertex_.reserve(patches * patch_vertices);
    uses_.reserve(patches * patch_vertices);
    id_of_.reserve(patches * capacity);
  }
  std::vector<Index> known_to(std::size_t(places_.vertex_count()), -1);  // the last patch
  std::vector<Index> ends;
  for (Index i = 0; i < count; ends.push_back(i)) {
    const Index p = append_patch(order[i]), end = std::min(count, i + capacity);
    for (; i < end && patches_[p].takes(order[i]); ++i) {
      const Corners& corners = order[i].corners;
      const auto unknown =
          std::count_if(corners.begin(), corners.end(), [&](Index v) { return known_to[v] != p; });
      if (patches_[p].vertices + unknown > patch_vertices) break;
      for (Index v : corners) {
        if (known_to[v] == p) continue;
        known_to[v] = p;
        vertex_[p * patch_vertices + patches_[p].vertices++] = v;
      }
    }
  }
  list_places(first_patch);
  for (Index i = 0, p = first_patch; p < patch_count(); i = ends[p++ - first_patch])
    for_strided(i, ends[p - first_patch], [&](Index at) { put(p, order[at]); });
}

template <int n>
void PatchLayout<n>::list_places(Index first_patch) {
  const auto for_places = [&](auto&& visit) {
    for (Index p = first_patch; p < patch_count(); ++p)
      for (Index i = 0; i < patches_[p].vertices; ++i) visit(p * patch_vertices + i);
  };
  if (first_patch == 0) {
    std::vector<Index> lengths(std::size_t(places_.vertex_count()), 0);
    for_places([&](Index place) { ++lengths[vertex_[place]]; });
    places_ = VertexLists<Index>(lengths);
  }
  const auto before = std::ptrdiff_t(used_.size());
  for_places([&](Index place) {
    places_.append(vertex_[place], place);
    use(vertex_[place]);
  });
  std::sort(used_.begin() + before, used_.end());
}

template <int n>
void PatchLayout<n>::use(Index vertex) {
  if (is_used_[vertex]) return;
  is_used_[vertex] = true;
  used_.push_back(vertex);
}

template <int n>
void PatchLayout<n>::take_up(Index p, const Corners& corners) {
  for (Index v : corners) {
    const Index known = local_number(p, v), number = known >= 0 ? known : number_vertex(p, v);
    ++uses_[p * patch_vertices + number];
  }
}

template <int n>
void PatchLayout<n>::let_go(Index p, const LocalCorners& corners) {
  for (std::uint8_t number : corners) {
    const Index place = p * patch_vertices + number;
    if (--uses_[place] > 0) continue;
    places_.erase_value(vertex_[place], place);
    ++patches_[p].free;
  }
}

template <int n>
bool PatchLayout<n>::renumber(const Item& item, const LocalCorners& before) {
  const Index p = slot_of_[item.id] / capacity;
  const Patch& patch = patches_[p];
  if (!patch.takes(item) || patch.vertices - patch.free + missing(p, item.corners) > patch_vertices)
    return false;
  take_up(p, item.corners);
  let_go(p, before);
  return true;
}

template <int n>
Index PatchLayout<n>::leave(Index id, const LocalCorners& corners) {
  const Index slot = slot_of_[id], p = slot / capacity;
  lobe_assert(slot >= 0, "patches: an item leaves that is in no patch");
  Patch& patch = patches_[p];
  let_go(p, corners);
  const Index last = p * capacity + --patch.items;
  id_of_[slot] = id_of_[last];
  slot_of_[id_of_[slot]] = slot;
  slot_of_[id] = -1;
  --item_count_;
  if (patch.items == 0) {
    patch.vertices = patch.free = 0;
    empty_.push_back(p);
  }
  return last;
}

// Finds the patch around an item that has most of its vertices, the first of several.
template <int n>
Index PatchLayout<n>::patch_for(const Item& item) {
  around_.clear();
  for (Index v : item.corners)
    for (Index place : places_[v]) {
      const Index p = place / patch_vertices;
      const auto known =
          std::find_if(around_.begin(), around_.end(), [&](const Near& near) { return near.patch == p; });
      if (known == around_.end())
        around_.push_back({p, 1});
      else
        ++known->vertices;
    }
  const Near* best = nullptr;
  for (const Near& near : around_)
    if ((!best || near.vertices > best->vertices) &&
        has_room(near.patch, item, Index(item.corners.size()) - near.vertices))
      best = &near;
  if (best) return best->patch;
  return open_ >= 0 && has_room(open_, item, missing(open_, item.corners)) ? open_ : open_patch(item);
}

template <int n>
Index PatchLayout<n>::missing(Index p, const Corners& corners) const {
  return static_cast<Index>(
      std::count_if(corners.begin(), corners.end(), [&](Index v) { return local_number(p, v) < 0; }));
}

template <int n>
bool PatchLayout<n>::has_room(Index p, const Item& item, Index new_vertices) const {
  const Patch& patch = patches_[p];
  return patch.takes(item) && patch.items < capacity &&
         patch.vertices - patch.free + new_vertices <= patch_vertices;
}

template <int n>
Index PatchLayout<n>::append_patch(const Item& of) {
  const Index p = patch_count();
  patches_.push_back({0, 0, 0, of.kind, of.pace});
  vertex_.resize(patches_.size() * patch_vertices, 0);
  uses_.resize(patches_.size() * patch_vertices, 0);
  id_of_.resize(patches_.size() * capacity, -1);
  return p;
}

template <int n>
Index PatchLayout<n>::open_patch(const Item& of) {
  while (!empty_.empty() && patches_[empty_.back()].items > 0) empty_.pop_back();
  if (empty_.empty()) return open_ = append_patch(of);
  open_ = empty_.back();
  empty_.pop_back();
  patches_[open_].kind = of.kind;
  patches_[open_].pace = of.pace;
  return open_;
}

template <int n>
Index PatchLayout<n>::local_number(Index p, Index vertex) const {
  for (Index place : places_[vertex])
    if (place / patch_vertices == p) return place % patch_vertices;
  return -1;
}

template <int n>
Index PatchLayout<n>::number_vertex(Index p, Index vertex) {
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
  use(vertex);
  return place % patch_vertices;
}

template <int n>
void PatchLayout<n>::put(Index p, const Item& item) {
  lobe_assert(slot_of_[item.id] < 0, "patches: an item enters that is in a patch");
  take_up(p, item.corners);
  lobe_assert(patches_[p].items < capacity && patches_[p].vertices <= patch_vertices,
              "patches: more in a patch than has room");
  const Index slot = p * capacity + patches_[p].items++;
  id_of_[slot] = item.id;
  slot_of_[item.id] = slot;
  ++item_count_;
}

std::vector<PatchLayout<4>::Item> items_of(RegionModel model, const Elements& elements, const Paces& paces,
                                           const std::vector<Index>& tets) {
  std::vector<PatchLayout<4>::Item> items;
  for (Index t : tets) {
    if (elements.region_of[t] != model) continue;
    const Eigen::Vector4i v = elements.topology.corners(t);
    items.push_back({t, {v[0], v[1], v[2], v[3]}, elements.material_of[t], paces.of(elements.topology, v)});
  }
  return items;
}

template class PatchLayout<any_number>;
template class PatchLayout<2>;
template class PatchLayout<4>;

}  // namespace lobe
