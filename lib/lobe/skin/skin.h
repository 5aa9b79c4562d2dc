// The skin is a fine surface with texture coordinates, such as the one that the mesh was made from. The
// tetrahedra carry it along, and it opens where they are cut.
//
// Each vertex is carried by one tetrahedron: it keeps its barycentric coordinates in it, outside of it by
// linear extension (the tetrahedra's own surface is coarser). A triangle lies on the tetrahedra under it
// (tets_under()). A vertex is carried by the nearest of the tetrahedra under the triangles around it.
//
// A triangle is shown while three conditions hold for the tetrahedra under it and those that carry its
// corners: all of them are there, any two of them share all the corners that they shared at the start, and
// all are connected by shared corners. The tetrahedra around a corner are connected by faces
// (mesh/topology.h), so no triangle ever bridges a gap between pieces. If the tetrahedron of a vertex is cut
// away, or is connected to none of the shown triangles around the vertex, another tetrahedron under these
// triangles carries it. A hidden triangle never comes back.
//
// If a blade has cut a tetrahedron, vertices lie on the copies whose grains are under them. The skin then
// opens along the cut. An edge of a triangle has a gap where the tetrahedra under it have come apart. Each
// gap gives the edge two new vertices, one for either side. Triangles whose edges have gaps are divided
// into parts (divide_triangle.h), so that nothing of them is lost. Where one copy of a tetrahedron is
// removed, what lies on its other copies goes with it.
#pragma once

#include "lobe/scalpel/grains.h"
#include "lobe/skin/divide_triangle.h"
#include "lobe/skin/skin_frame.h"

namespace lobe {

// Returns the boundary of the tetrahedra, for bodies without a finer surface. It has all points of the mesh.
TexturedSurface textured_boundary(const TetMesh& mesh);

class Skin {
 public:
  // The mesh is that of the body at the start. Both are copied. Throws InputError for a body without
  // tetrahedra or a surface without triangles. O(#triangles log #tets).
  Skin(const TexturedSurface& surface, const TetMesh& mesh);

  // Call it after each edit of the topology. O(what lies on the tetrahedra that are gone, or have other
  // corners). `grains`: World::grains(); null where no blade has cut. Without it what a blade cuts is hidden.
  void follow(const Topology& topology, const MeshEdit& edit, const Grains* grains = nullptr);
  // Follows all edits since the start at once, for instance of a world that was restored. O(#triangles).
  void follow_all(const Topology& topology, const Grains* grains = nullptr);

  const SkinMesh& mesh() const { return mesh_; }
  double farthest() const { return farthest_; }  // largest distance of a vertex at the start [m]
  // The number of triangles whose tetrahedra were not connected at the start, because the triangles are far
  // outside of the body or span a hollow of it. They are shown all the same, and may bridge gaps.
  Index loose_count() const;

  // Whether a blade has divided triangles. Their parts are several triangles of one number in the file.
  bool is_divided() const { return !state_.divided.empty(); }

  // Computes positions and unit normals of the vertices. A normal is the sum of the normals of the shown
  // triangles, weighted by area; it is zero where none is shown. In single precision, for drawing.
  // O(#vertices of skin and mesh), about 10 ns each.
  void update(const Eigen::Ref<const Mat3X<double>>& X,  // 3 × #vertices of the topology, at rest [m]
              const Eigen::Ref<const Mat3X<float>>& u,   // 3 × #vertices of the topology, displacements [m]
              Mat3X<float>& x, Mat3X<float>& normals);   // out: 3 × #vertices of the skin [m], [1]
  void update(const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<double>>& u,
              Mat3X<float>& x, Mat3X<float>& normals);

 private:
  using Edge = SkinState::Edge;
  using Gap = SkinState::Gap;
  using CutVertex = SkinState::CutVertex;
  using Divided = SkinState::Divided;

  void choose_carriers(const Topology& topology);
  void carry(Index vertex, Index element, const Topology& topology);
  Bond bond_of(const Topology& topology, Index triangle, std::span<const Index> corners) const;
  bool holds(const Topology& topology, Index triangle, std::span<const Index> corners) const;
  bool holds_to_any(const Topology& topology, Index vertex) const;
  void drop(std::vector<Index>& triangles);
  void follow(const Topology& topology, std::vector<Index>& triangles, std::vector<Index>& vertices,
              std::vector<Index>& cut, const Grains* grains);
  void check(const Topology& topology, std::vector<Index>& triangles, const std::vector<Index>& vertices);
  std::vector<Index> candidates(Index vertex) const;

  // ---- What blades have cut (skin_grains.cpp)

  struct Owner {    // an element under an edge
    Index element;  // −1: gone
    double share;   // share of the edge
  };
  struct CutBody {  // present body
    const Topology& topology;
    const Grains& grains;
  };
  void follow_grains(const CutBody& body, const std::vector<Index>& cut);
  void open(const CutBody& body, std::vector<Index>& triangles, const std::vector<Index>& vertices);
  bool has_lost_a_tet(const CutBody& body, Index triangle) const;
  std::span<const Index> copies_of(Index tet) const;
  template <class Visit>
  void for_elements(Index tet, Visit&& visit) const;  // takes the tetrahedron and its copies
  bool has_lost_a_copy(const Topology& topology, Index tet) const;
  Index under(const CutBody& body, Index vertex) const;  // −1: its tetrahedron is gone
  Index under(const CutBody& body, std::span<const Index> tets, const Vec3d& p, Index before) const;
  std::vector<Index> triangles_at(const Edge& edge) const;
  bool may_have_gaps(const CutBody& body, const Edge& edge, const std::vector<Index>& tets) const;
  std::vector<Gap> gaps_of(const CutBody& body, const Edge& edge) const;
  void find_gaps(const CutBody& body, const Edge& edge, const std::vector<Index>& tets, const Owner& from,
                 const Owner& to, std::vector<Gap>& gaps) const;

  // ---- Parts of triangles (skin_parts.cpp)

  struct OnEdge {            // a place on an edge; for a vertex of the file a is b and the share 0
    Index a, b;              // carried vertices, the lower number first
    Index drawn_a, drawn_b;  // numbers of a and b as they are drawn
    double share;            // share of the way from a to b
  };
  struct Rim {
    std::vector<RimPoint> points;
    std::vector<OnEdge> places;  // their places on edges
  };
  Rim rim_of(const CutBody& body, Index triangle, const Eigen::Vector3i& drawn) const;
  Vec3d at_rest(const OnEdge& place) const;
  Index under_middle(const CutBody& body, Index triangle, const Rim& rim) const;
  void divide(const CutBody& body, Index triangle);
  Index show_part(const Topology& topology, Index triangle, const Rim& rim, const TrianglePart& part);
  Index cut_vertex(const Topology& topology, const OnEdge& place, Index element);
  void add_cut_vertex();
  void update_cut_vertices(const Topology& topology, Index triangle);
  void show(Index number, Index file_triangle, const Eigen::Vector3i& drawn, const Eigen::Vector3i& carried);
  void take_out(Index number);
  Eigen::Vector3i take_apart(Index triangle);
  void begin_revision();

  SkinMesh mesh_;
  SkinBinding rest_;
  std::vector<std::uint8_t> is_loose_;  // flag of each triangle of the file: see loose_count()
  double farthest_ = 0;                 // distance of a vertex from its tetrahedron at the start [m]
  SkinState state_;
  bool has_new_revision_ = false;  // whether this edit has one
  SkinFrame frame_;
};

}  // namespace lobe
