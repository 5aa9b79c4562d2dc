// Divides items of n vertices each (tetrahedra, edges), or of any number each (the smoothing domains of
// edges), into patches, and numbers them and their vertices within a patch. A patch has items of one kind
// and one pace that lie close together: consecutive ones along a Hilbert curve through their barycentres, as
// many as have room. The last item of a patch takes the place of one that leaves. An item that enters goes to
// a patch that has its vertices. An item that only gets other corners stays in its patch while that has free
// vertex numbers. A cut changes the corners of many items at once. If they left, they would fill new patches
// of their own.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>
#include <vector>

#include "lobe/fem/elements.h"
#include "lobe/mesh/vertex_lists.h"

namespace lobe {

inline constexpr Index patch_vertices = 256;  // most vertices of a patch: one byte numbers them
inline constexpr int any_number = 0;          // of vertices per item

// Reserves room for the patches that cuts add, so that cuts seldom copy the array. The room takes no memory
// until it is touched.
template <class Item>
void resize_with_room(std::vector<Item>& items, std::size_t count) {
  if (items.empty()) items.reserve(count + count / 4);
  items.resize(count);
}

template <int n>
class PatchLayout {
 public:
  static constexpr Index capacity = n == 2 ? 1024 : 512;  // items
  template <class Number>
  using PerCorner =
      std::conditional_t<n == any_number, std::vector<Number>, std::array<Number, std::size_t(n)>>;
  using Corners = PerCorner<Index>;
  using LocalCorners = PerCorner<std::uint8_t>;

  struct Item {
    Index id = 0;
    Corners corners{};
    std::uint16_t kind = 0;
    std::uint8_t pace = 0;  // of Paces
  };
  struct Patch {
    Index items = 0;     // number of items, in slots from capacity × its number on, without gaps
    Index vertices = 0;  // numbers handed out, from 0 on: those in use, and those to be used again
    Index free = 0;      // numbers that are not in use
    std::uint16_t kind = 0;
    std::uint8_t pace = 0;
    bool takes(const Item& item) const { return kind == item.kind && pace == item.pace; }
  };

  Index item_count() const { return item_count_; }
  Index patch_count() const { return static_cast<Index>(patches_.size()); }
  const Patch& patch(Index p) const { return patches_[p]; }
  Index id_count() const { return static_cast<Index>(slot_of_.size()); }  // those in no patch included
  Index slot_of(Index id) const { return slot_of_[id]; }                  // −1 if it is in no patch
  Index id_of(Index slot) const { return id_of_[slot]; }

  // Vertices by the patch's numbers; any vertex where a number is not in use.
  const Index* vertices(Index p) const { return vertex_.data() + std::size_t(p) * patch_vertices; }
  std::span<const Index> vertices_of(Index p) const {
    return {vertices(p), std::size_t(patches_[p].vertices)};
  }
  // The places of each vertex of the mesh: patch_vertices × patch + number there.
  const VertexLists<Index>& places() const { return places_; }
  // The vertices that have places, or had some.
  const std::vector<Index>& used_vertices() const { return used_; }
  LocalCorners local_corners(Index p, const Corners& corners) const;

  // Makes room for the vertices and ids that are new.
  void resize(Index vertex_count, Index id_count);
  void enter(const std::vector<Item>& items, const Mat3X<double>& points);  // points: 3 × #vertices [m]
  // Items that are here and get other corners keep their slots if their patches have numbers for these.
  // Returns the others, and those that are new. Call it before these leave.
  template <class CornersIn>  // corners_in(slot): LocalCorners
  std::vector<Item> keep(const std::vector<Item>& items, CornersIn&& corners_in) {
    is_kept_.assign(slot_of_.size(), false);
    std::vector<Item> others;
    for (const Item& item : items) {
      const Index slot = slot_of(item.id);
      if (slot >= 0 && renumber(item, corners_in(slot)))
        is_kept_[std::size_t(item.id)] = true;
      else
        others.push_back(item);
    }
    return others;
  }
  bool must_leave(Index id) const { return slot_of(id) >= 0 && !is_kept_[std::size_t(id)]; }
  // The slot that it leaves is that of the last item of its patch from now on, whose former slot is returned.
  // O(1).
  Index leave(Index id, const LocalCorners& corners);

 private:
  struct Near {
    Index patch;
    Index vertices;  // vertices of the item that it has
  };
  void fill_new_patches(const std::vector<Item>& items, const Mat3X<double>& points);
  void list_places(Index first_patch);
  Index patch_for(const Item& item);
  bool renumber(const Item& item, const LocalCorners& before);
  Index missing(Index p, const Corners& corners) const;
  bool has_room(Index p, const Item& item, Index new_vertices) const;
  Index append_patch(const Item& of);
  Index open_patch(const Item& of);
  Index local_number(Index p, Index vertex) const;  // −1 if it has none
  Index number_vertex(Index p, Index vertex);
  void use(Index vertex);
  void take_up(Index p, const Corners& corners);
  void let_go(Index p, const LocalCorners& corners);
  void put(Index p, const Item& item);

  std::vector<Patch> patches_;
  std::vector<Index> vertex_;        // vertex of each place
  std::vector<std::uint16_t> uses_;  // corners of items at each place
  VertexLists<Index> places_;
  std::vector<Index> used_;
  std::vector<bool> is_used_;           // flag of each vertex
  std::vector<Index> id_of_, slot_of_;  // id of each slot; slot of each id
  std::vector<Near> around_;            // scratch of patch_for()
  std::vector<Index> empty_;            // patches, some of which may have been filled again
  std::vector<bool> is_kept_;           // ids kept in the last edit
  Index open_ = -1;                     // patch that takes what fits nowhere else
  Index item_count_ = 0;
};

// The level at which each vertex may step at rest (time/own_steps.h). Patches are laid out by it.
struct Paces {
  std::vector<std::uint8_t> of_vertices;  // of the mesh at the start, whose copies have theirs; none: all 0

  template <class Vertices>
  std::uint8_t of(const Topology& topology, const Vertices& vertices) const {  // the lowest of an item's
    if (of_vertices.empty()) return 0;
    std::uint8_t lowest = 255;
    for (const Index v : vertices) lowest = std::min(lowest, of_vertices[std::size_t(topology.origin(v))]);
    return lowest;
  }
};

// Returns the items of those tetrahedra that are of this model, by material and pace.
std::vector<PatchLayout<4>::Item> items_of(RegionModel model, const Elements& elements, const Paces& paces,
                                           const std::vector<Index>& tets);

extern template class PatchLayout<any_number>;
extern template class PatchLayout<2>;
extern template class PatchLayout<4>;

}  // namespace lobe
