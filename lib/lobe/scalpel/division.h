// What grains that have come apart mean for the simulation: which vertices are doubled, and which tetrahedra
// are divided.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "lobe/scalpel/grains.h"

namespace lobe {

// Grains of the tetrahedra around a vertex hang together there if one can go from each to each across faces
// of these tetrahedra. Where two tetrahedra are joined across a face, they share its three vertices.
class Division {
 public:
  using Corners = Eigen::Vector4i;
  using GrainPair = std::pair<Index, Index>;

  struct Scratch {                      // −1 outside of a division
    std::vector<Index>&marks, &places;  // per grain
    std::vector<Index>& sides;          // per vertex
  };

  // `parted`: the grains on both sides of each face that has opened. `is_whole`: per vertex, whether the
  // grains around it are known to have hung together before.
  Division(const Grains& grains, const Topology& topology, const std::vector<Index>& touched,
           const std::vector<GrainPair>& parted, Scratch scratch, std::vector<std::uint8_t>& is_whole);
  ~Division() {
    for (const Changed& changed : changed_) places_[std::size_t(changed.grain)] = -1;
    for (Index v : vertices_) first_side_[std::size_t(v)] = -1;
  }
  Division(const Division&) = delete;
  Division& operator=(const Division&) = delete;

  TetDivision find();
  // Grains, and the tetrahedra that they are part of now.
  std::vector<std::pair<Index, Index>> moved_grains() const;

 private:
  struct Changed {  // a grain whose tetrahedron will have another number or other corners
    Index grain, element;
    Corners corners;  // corners of its tetrahedron, as they will be
    bool has_new_corners = false;
  };
  struct Part {  // part of a tetrahedron that was divided or has new corners
    Index tet;
    Index begin, end;  // range in grains_of_parts_
  };

  // Marks of a grain around a vertex: it has not been found yet, or has.
  static constexpr Index is_around = 0, is_found = 1;
  Index& mark(Index grain) { return marks_[std::size_t(grain)]; }
  const Changed* find_changed(Index grain) const {
    const Index place = places_[std::size_t(grain)];
    return place < 0 ? nullptr : &changed_[std::size_t(place)];
  }
  Changed& changed(Index grain);
  Index element_of(Index grain) const {
    const Changed* changed = find_changed(grain);
    return changed ? changed->element : grains_[grain].element;
  }
  Corners corners_of(Index grain) const {
    const Changed* changed = find_changed(grain);
    return changed ? changed->corners : topology_.corners(grains_[grain].element);
  }

  static bool has(const Corners& corners, Index v) { return (corners.array() == v).any(); }
  template <class Visit>  // visit(pair, vertex) of both tetrahedra that the grains beside a face are part of
  void for_common_vertices(Visit&& visit) const {
    for (const GrainPair& pair : parted_) {
      const Corners a = topology_.corners(grains_[pair.first].element),
                    b = topology_.corners(grains_[pair.second].element);
      for (Index v : a)
        if (has(b, v)) visit(pair, v);
    }
  }
  void mark_star(Index v);
  void find_rest(Index first);
  void add_connected(std::size_t begin);
  bool find_parts_at_sides(Index v);
  bool was_whole(Index v);
  bool may_part() const;
  bool find_parts(Index v);
  void split(Index v);
  std::vector<Index> changed_tets() const;
  void divide(Index tet);
  void find_neighbours();
  void add_neighbours(Index tet, std::span<const Index> grains);

  const Grains& grains_;
  const Topology& topology_;
  const std::vector<GrainPair>& parted_;
  std::vector<Index>& marks_;   // per grain; −1 outside of a search
  std::vector<Index>& places_;  // per grain, in changed_; −1: none
  std::vector<std::uint8_t>& is_whole_;
  std::vector<Index> vertices_;
  struct Side {         // a grain beside a face that opened
    Index grain, next;  // a grain, and the next entry of the same vertex in sides_; negative: the last
  };
  std::vector<Side> sides_;
  std::vector<Index>& first_side_;  // per vertex, in sides_; negative: none
  std::vector<Changed> changed_;
  std::vector<Index> star_, front_;  // grains around a vertex; the same, part by part
  struct Connected {
    Index first;             // the lowest number
    std::size_t begin, end;  // range in front_
  };
  std::vector<Connected> connected_;     // parts of what is around a vertex
  std::vector<Part> parts_, new_parts_;  // parts by number: of old tetrahedra, of new ones
  std::vector<Index> grains_of_parts_;
  struct Group {  // group of grains with the same corners
    Corners corners;
    double share = 0;
  };
  std::vector<Group> groups_;                                 // scratch of divide()
  std::vector<std::pair<std::size_t, Index>> grains_of_tet_;  // the same: groups, and their grains
  std::array<std::vector<Index>, 4> across_;                  // scratch of add_neighbours()
  std::vector<Index> others_;                                 // the same
  Index new_tets_ = 0;
  TetDivision result_;
};

}  // namespace lobe
