// Which tetrahedra share a patch, and how it numbers them and their vertices. A patch has tetrahedra of one material that
// lie together: consecutive ones along a Hilbert curve through their barycentres, as many as find room. What leaves is
// replaced by the last of its patch; what enters goes to a patch which knows its vertices.
#pragma once

#include <vector>

#include "lobe/mesh/vertex_lists.h"
#include "lobe/region/element_block.h"
#include "lobe/region/elements.h"

namespace lobe {

class PatchLayout {
 public:
  struct Patch {
    Index tets = 0;      // in slots from patch_tets × its number on, without gaps
    Index vertices = 0;  // numbers handed out, from 0 on: those in use, and those to be used again
    Index free = 0;      // of these, not in use
    std::uint16_t material = 0;
  };

  Index tet_count() const { return tet_count_; }
  Index patch_count() const { return static_cast<Index>(patches_.size()); }
  const Patch& patch(Index p) const { return patches_[p]; }
  Index slot_of(Index tet) const { return slot_of_tet_[tet]; }  // −1 if it is in no patch
  Index tet_of(Index slot) const { return tet_of_slot_[slot]; }

  // Vertices by the patch's numbers; any vertex where a number is not in use.
  const Index* vertices(Index p) const { return vertex_.data() + std::size_t(p) * patch_vertices; }
  // Per vertex of the mesh: its places, patch_vertices × patch + number there.
  const VertexLists<Index>& places() const { return places_; }
  std::array<std::uint8_t, 4> local_corners(Index p, const Eigen::Vector4i& corners) const;

  // Makes room for what edits may have added to the mesh.
  void resize(const Topology& topology);
  void enter(const Elements& elements, const std::vector<Index>& tets);
  // The slot that it leaves is that of the last tetrahedron of its patch from now on, whose former slot is returned. O(1).
  Index leave(Index tet, const std::array<std::uint8_t, 4>& local_corners);

 private:
  void fill_new_patches(const Elements& elements, const std::vector<Index>& tets);
  void list_places(Index first_patch, Index vertex_count);
  Index patch_for(const Elements& elements, Index tet);
  bool has_room(Index p, std::uint16_t material, const Eigen::Vector4i& corners) const;
  Index append_patch(std::uint16_t material);
  Index open_patch(std::uint16_t material);
  Index local_number(Index p, Index vertex) const;  // −1 if it has none
  Index number_vertex(Index p, Index vertex);
  void put(Index p, Index tet, const Eigen::Vector4i& corners);

  std::vector<Patch> patches_;
  std::vector<Index> vertex_;        // per place
  std::vector<std::uint16_t> uses_;  // per place: corners of tetrahedra
  VertexLists<Index> places_;
  std::vector<Index> tet_of_slot_, slot_of_tet_;
  std::vector<Index> empty_;  // patches, some of which may have been filled again
  Index open_ = -1;           // patch that takes what fits nowhere else
  Index tet_count_ = 0;
};

}  // namespace lobe
