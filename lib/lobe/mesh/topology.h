// The topology of a mesh that is being cut: neighbours across faces, the tetrahedra around each vertex, the
// boundary surface. It is edited in place. Every other structure follows the record that an edit returns.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lobe/mesh/tet_mesh.h"
#include "lobe/mesh/vertex_columns.h"
#include "lobe/mesh/vertex_lists.h"

namespace lobe {

// The split of a vertex whose tetrahedra are no longer connected by faces. Some of them get a copy of
// it.
struct VertexSplit {
  Index vertex = 0;
  Index copy = 0;           // a new vertex, numbered after all others
  std::vector<Index> tets;  // tetrahedra that now have the copy for a corner
};

// If a blade has cut a tetrahedron, there is a copy of it for each part that has vertices of its own. The
// copies have the same shape and share its volume (Elements::share_of).
struct TetCopy {
  Index tet = 0;
  Index copy = 0;  // a new tetrahedron, numbered after all others
};
struct TetShare {
  Index tet = 0;
  double share = 1;
};

// One edit of the mesh, in this order: tetrahedra removed, tetrahedra copied, then vertices split.
struct MeshEdit {
  std::vector<Index> removed;
  std::vector<TetCopy> copies;
  std::vector<TetShare> shares;  // shares of all that have another share than before
  std::vector<VertexSplit> splits;
  // For each connected part of the removed tetrahedra: one tetrahedron next to it that is left.
  std::vector<Index> next_to_removed;
  // The pieces into which the body came apart, except the piece of next_to_removed[0]. Empty if it did not.
  std::vector<std::vector<Index>> cut_off;

  bool empty() const { return removed.empty() && copies.empty() && splits.empty(); }
};

// How a blade has divided the tetrahedra that it met, for Topology::divide().
struct TetDivision {
  std::vector<Index> vertices;  // split vertices: each gives one new vertex, numbered after all others
  struct Part {
    Index tet;  // the divided tetrahedron, or a new one: these are numbered after all others, in this order
    Index of;   // the divided tetrahedron
    Eigen::Vector4i corners;
    double share;
  };
  std::vector<Part> parts;  // all of each tetrahedron that was divided or has new corners
  struct Neighbours {
    Index tet = 0;
    std::array<Index, 5> begin{};  // begin of each face's in others; and the end
  };
  std::vector<Neighbours> neighbours;  // neighbours of the parts, and of all next to them; ascending
  std::vector<Index> others;
  bool may_part = true;  // false: nothing has come off, there is no need to search
  std::span<const Index> across(const Neighbours& of, std::size_t face) const {
    return {others.data() + of.begin[face], others.data() + of.begin[face + 1]};
  }
};

class Topology {
 public:
  explicit Topology(const TetMesh& mesh);

  // Numbers never change; a removed tetrahedron keeps its number and its last corners.
  Index vertex_count() const { return around_.vertex_count(); }
  Index tet_count() const { return tets_.count(); }
  Index alive_count() const { return alive_count_; }
  bool alive(Index tet) const { return alive_[tet] != 0; }
  VertexColumns<Tets>::View tets() const { return tets_.view(); }
  Eigen::Vector4i corners(Index tet) const { return tets_.col(tet); }
  Index origin(Index v) const {  // the vertex of the mesh at the start that it is, or is a copy of
    const Index copy = v - (vertex_count() - copy_count());
    return copy < 0 ? v : origins_[copy];
  }
  Index copy_count() const { return static_cast<Index>(origins_.size()); }

  // Alive tetrahedra that have v for a corner; a vertex without any is an orphan and stays where it is.
  std::span<const Index> around(Index v) const { return around_[v]; }
  // Whether the tetrahedra around each vertex are known to be connected by faces, with one neighbour across
  // each.
  bool stars_are_whole() const { return stars_are_whole_; }
  Index parent(Index tet) const {  // the tetrahedron of the mesh at the start that it is, or is a copy of
    const Index copy = tet - (tet_count() - tet_copy_count());
    return copy < 0 ? tet : parents_[copy];
  }
  Index tet_copy_count() const { return static_cast<Index>(parents_.size()); }
  // The neighbour across the face opposite to a corner, the first if there are several; −1 on the boundary.
  Index neighbour(Index tet, int face) const { return std::max(neighbours_(face, tet), -1); }
  // The boundary as codes 4 × tetrahedron + corner opposite to the face, in no particular order.
  const std::vector<Index>& boundary_faces() const { return boundary_; }
  Eigen::Vector3i face(Index code) const;

  // Removes the alive ones of these tetrahedra. If the remaining tetrahedra around a vertex fall into parts
  // that share no face, the vertex is split. So no parts are connected by a single vertex. Costs O(tetrahedra
  // around these vertices), and a search from all sides of the cut until they meet, or until the smaller
  // pieces are all found.
  MeshEdit remove(std::span<const Index> tets);

  // Gives numbers and neighbours to the parts of tetrahedra that a blade has cut. O(size of the division).
  MeshEdit divide(const TetDivision& division);

  // Calls visit(face, other) for each neighbour of a tetrahedron. There is one across each face, or several
  // where copies share it.
  template <class Visit>
  void for_neighbours(Index tet, Visit&& visit) const {
    for (int f = 0; f < 4; ++f)
      if (neighbours_(f, tet) >= 0) visit(f, neighbours_(f, tet));
    if (!has_more(tet)) return;
    for (const Across& more : more_[tet]) visit(more.face, more.tet);
  }

  // Calls visit(t) for all tetrahedra that are connected with this one by faces, breadth first, until it
  // returns true. Returns whether it did. O(#tetrahedra visited).
  template <class Visit>
  bool visit_piece(Index tet, Visit&& visit) {
    std::vector<Index> queue{tet};
    found_by_[tet] = tet;
    bool found = false;
    for (std::size_t at = 0; at < queue.size() && !found; ++at) {
      found = visit(queue[at]);
      for_neighbours(queue[at], [&](int, Index other) {
        if (found_by_[other] >= 0) return;
        found_by_[other] = tet;
        queue.push_back(other);
      });
    }
    for (Index t : queue) found_by_[t] = -1;
    return found;
  }

  // The pieces of the body, which are connected by faces: #pieces lists of tetrahedra, in the order of their
  // first ones. O(#tets).
  std::vector<std::vector<Index>> pieces() const;

 private:
  struct Across {
    int face;
    Index tet;
  };
  bool has_more(Index tet) const {
    return std::size_t(tet) < has_more_.size() && has_more_[std::size_t(tet)] != 0;
  }
  void forget_neighbour(Index tet, Index other);
  void set_neighbours(Index tet, int face, std::span<const Index> others);
  void add_neighbour(Index tet, int face, Index other);
  void take_corners(Index tet, const Eigen::Vector4i& corners);
  void split_vertices(const TetDivision& division, MeshEdit& edit);
  std::vector<Index> rims_of(const std::vector<Index>& removed, std::vector<Index>& ends);
  std::vector<std::vector<Index>> pieces_apart(std::span<const Index> tets, Index& left);
  void find_cut_off(const std::vector<Index>& rims, const std::vector<Index>& ends, MeshEdit& edit);
  void unlink(Index tet);
  void open_face(Index code);
  void close_face(Index code);
  void split_if_apart(Index v, std::vector<VertexSplit>& splits);
  Index parts_around(Index v);
  bool ring_closes(Index from, Index to, Index v, Index w, Index behind) const;
  std::array<bool, 4> stays_whole(const Eigen::Vector4i& corners, const Eigen::Vector4i& neighbours) const;

  VertexColumns<Tets> tets_;
  VertexColumns<Tets>
      neighbours_;  // per face: the first other tetrahedron; on the boundary −1 − its place in boundary_
  VertexLists<Across> more_;            // further ones across its faces; no lists until there is one
  std::vector<std::uint8_t> has_more_;  // whether the list of each tetrahedron has an item
  bool stars_are_whole_ = true;         // the tetrahedra around each vertex are connected by faces
  std::vector<std::uint8_t> alive_;
  Index alive_count_ = 0;
  VertexLists<Index> around_;
  std::vector<Index> origins_;          // originals of the copied vertices
  std::vector<Index> parents_;          // originals of the copied tetrahedra
  std::vector<Index> found_by_;         // scratch of a search: per tetrahedron, −1 outside of it
  std::vector<Index> part_of_, front_;  // scratch of parts_around()
  std::vector<Index> boundary_;
};

// The mesh that is left, renumbered without removed tetrahedra and orphans, in the old order.
struct CompactMesh {
  TetMesh mesh;
  std::vector<Index> vertex_source;  // old number of each new vertex
  std::vector<Index> tet_source;
  std::vector<Index> vertex_target;  // new number of each old vertex, −1 for an orphan
  std::vector<Index> tet_target;
};
CompactMesh compact(const Topology& topology, const Mat3X<double>& points,  // 3 × topology.vertex_count() [m]
                    const std::vector<int>& labels);  // label of each tetrahedron; none: all are 0

}  // namespace lobe
