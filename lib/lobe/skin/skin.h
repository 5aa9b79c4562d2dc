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

#include <map>
#include <tuple>

#include "lobe/io/surface_io.h"
#include "lobe/mesh/slot_log.h"
#include "lobe/mesh/vertex_lists.h"
#include "lobe/scalpel/grains.h"
#include "lobe/skin/carriers.h"
#include "lobe/skin/divide_triangle.h"

namespace lobe {

// All of the skin but positions and normals. A vertex of the file that has several texture coordinates or
// normals is several vertices here, so that the skin is creased as it is in the file.
struct SkinMesh {
  std::uint64_t revision = 0;              // grows by one with each change of what is shown
  std::vector<Eigen::Vector3i> triangles;  // those that are shown; counter-clockwise seen from outside
  std::vector<Index> file_triangle;        // per triangle: that of the file which it is, or is a part of
  SlotLog changed_triangles;               // as in Surface: arrays without gaps

  // One per vertex. Vertices of the file never change. Behind them are those that blades have made. One that
  // no triangle uses any more stays until another takes its place.
  std::vector<Index> file_vertex;        // its number in the file; of one between two, the nearer
  std::vector<Eigen::Vector2f> texture;  // 0 where the file has none
  struct Between {                       // at rest on the line from a to b, which are vertices of the file
    Index a, b;
    float share;
  };
  std::vector<Between> between;  // the last vertices
  SlotLog changed_vertices;

  Index vertex_count() const { return static_cast<Index>(file_vertex.size()); }
  Index triangle_count() const { return static_cast<Index>(triangles.size()); }
};

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
  // The same for all edits since the start at once, for instance of a world that was restored. O(#triangles).
  void follow_all(const Topology& topology, const Grains* grains = nullptr);

  const SkinMesh& mesh() const { return mesh_; }
  double farthest() const { return farthest_; }  // that a vertex was from its tetrahedron at the start [m]
  // The number of triangles whose tetrahedra were not connected at the start, because the triangles are far
  // outside of the body or span a hollow of it. They are shown all the same, and may bridge gaps.
  Index loose_count() const;

  // Whether a blade has divided triangles. Their parts are several triangles of one number in the file.
  bool is_divided() const { return !divided_.empty(); }

  // Computes positions and unit normals of the vertices. A normal is the sum of the normals of the shown
  // triangles, weighted by area; it is zero where none is shown. In single precision, for drawing.
  // O(#vertices of skin and mesh), about 10 ns each.
  void update(const Eigen::Ref<const Mat3X<double>>& X,  // 3 × #vertices of the topology, at rest [m]
              const Eigen::Ref<const Mat3X<float>>& u,   // the same, displacements [m]
              Mat3X<float>& x, Mat3X<float>& normals);   // out: 3 × #vertices of the skin [m], [1]
  void update(const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<double>>& u,
              Mat3X<float>& x, Mat3X<float>& normals);

 private:
  using Padded = std::vector<Eigen::Vector4f>;  // three numbers that fill a vector register

  void add_vertices(const TexturedSurface& surface);
  void add_texture(const TexturedSurface& surface);
  void choose_carriers(const Topology& topology);
  void carry(Index vertex, Index element, const Topology& topology);
  std::span<const Index> corners_in(Index triangle) const { return {corners_of_.col(triangle).data(), 3}; }
  Bond bond_of(const Topology& topology, Index triangle, std::span<const Index> corners) const;
  bool holds(const Topology& topology, Index triangle, std::span<const Index> corners) const;
  bool holds_to_any(const Topology& topology, Index vertex) const;
  void drop(std::vector<Index>& triangles);
  void follow(const Topology& topology, std::vector<Index>& triangles, std::vector<Index>& vertices,
              std::vector<Index>& cut, const Grains* grains);
  void check(const Topology& topology, std::vector<Index>& triangles, const std::vector<Index>& vertices);
  std::vector<Index> candidates(Index vertex) const;
  Index file_count() const { return lies_on_.count(); }  // triangles of the file

  // ---- What blades have cut (skin_grains.cpp)

  struct Gap {            // of an edge from its vertex of the lower number
    double share;         // where it is
    Index before, after;  // what the edge lies on before and behind it; −1: what is gone
    bool operator==(const Gap&) const = default;
  };
  using Edge = std::pair<Index, Index>;  // carried vertices, ascending
  struct Owner {
    Index element;  // −1: gone
    double share;   // of the edge
  };
  struct Body {  // as it is now
    const Topology& topology;
    const Grains& grains;
  };
  void follow_grains(const Body& body, const std::vector<Index>& cut);
  void open(const Body& body, std::vector<Index>& triangles, const std::vector<Index>& vertices);
  bool has_lost_a_tet(const Body& body, Index triangle) const;
  std::span<const Index> copies_of(Index tet) const;
  template <class Visit>
  void for_elements(Index tet, Visit&& visit) const;  // the tetrahedron and its copies
  bool has_lost_a_copy(const Topology& topology, Index tet) const;
  Index under(const Body& body, Index vertex) const;  // −1: what is gone
  Index under(const Body& body, std::span<const Index> tets, const Vec3d& p, Index before) const;
  std::vector<Index> triangles_at(const Edge& edge) const;
  bool may_have_gaps(const Body& body, const Edge& edge, const std::vector<Index>& tets) const;
  std::vector<Gap> gaps_of(const Body& body, const Edge& edge) const;
  void find_gaps(const Body& body, const Edge& edge, const std::vector<Index>& tets, const Owner& from,
                 const Owner& to, std::vector<Gap>& gaps) const;

  // ---- Parts of triangles (skin_parts.cpp)

  struct OnEdge {            // a place; or a vertex of the file, where a is b and the share 0
    Index a, b;              // carried vertices, the lower number first
    Index drawn_a, drawn_b;  // as they are drawn
    double share;            // from a to b
  };
  struct Rim {
    std::vector<RimPoint> points;
    std::vector<OnEdge> places;  // of these
  };
  using Place = std::tuple<Index, Index, double, Index>;  // as drawn, share, element
  struct CutVertex {                                      // that blades have made
    Place place;
    Index element = -1;
    Eigen::Vector4i corners = Eigen::Vector4i::Zero();
    Eigen::Vector4f weights = Eigen::Vector4f::Zero();
    int uses = 0;  // corners of parts
  };
  struct Divided {             // a triangle of the file
    Eigen::Vector3i corners;   // as they are drawn
    std::vector<Index> parts;  // their numbers
  };
  Index first_cut() const {
    return static_cast<Index>(points_.cols()) + static_cast<Index>(copied_from_.size());
  }
  Rim rim_of(const Body& body, Index triangle, const Eigen::Vector3i& drawn) const;
  Vec3d at_rest(const OnEdge& place) const;
  Index under_middle(const Body& body, Index triangle, const Rim& rim) const;
  void divide(const Body& body, Index triangle);
  Index show_part(const Topology& topology, Index triangle, const Rim& rim, const TrianglePart& part);
  Index cut_vertex(const Topology& topology, const OnEdge& place, Index element);
  void add_cut_vertex();
  void update_cut_vertices(const Topology& topology, Index triangle);
  void show(Index number, Index file_triangle, const Eigen::Vector3i& drawn, const Eigen::Vector3i& carried);
  void take_out(Index number);
  Eigen::Vector3i take_apart(Index triangle);
  void begin_revision();
  void list_parts_around();
  void find_cut_positions(Mat3X<float>& x);
  void find_cut_normals(Mat3X<float>& normals) const;

  template <class Real>
  void update_from(const Eigen::Ref<const Mat3X<double>>& X, const Eigen::Ref<const Mat3X<Real>>& u,
                   Mat3X<float>& x, Mat3X<float>& normals);
  void find_positions(Mat3X<float>& x);
  void find_normals(Mat3X<float>& normals);
  void find_areas();
  void list_triangles_around();

  TetMesh start_;
  SkinMesh mesh_;
  double farthest_ = 0;
  Mat3X<double> points_;            // at rest, of the carried vertices [m]
  std::vector<Index> copied_from_;  // of the vertices behind the carried ones: they differ in texture alone
  Triangles corners_of_;            // 3 × #triangles of the file, carried vertices
  std::vector<Eigen::Vector3i> shown_;  // as mesh_.triangles, of carried vertices and those of blades
  // Numbers of triangles are those of the file, one of no area, then those of parts.
  std::vector<Index> slot_of_;               // per number; −1: not shown
  std::vector<Index> number_of_;             // per slot
  std::vector<std::uint8_t> is_loose_;       // per triangle of the file: see loose_count()
  NumberLists lies_on_, lying_on_, around_;  // tets of triangles, triangles of tets and of carried vertices
  std::vector<Index> carrier_, element_;     // per carried vertex: its tetrahedron, and which copy of it
  VertexLists<Index> carried_by_;            // per tetrahedron: vertices
  std::vector<Eigen::Vector4f> weights_;     // per carried vertex
  std::vector<Eigen::Vector4i> carrier_corners_;  // the same: vertices of the mesh
  // Per carried vertex: six triangles around it; where there are fewer, one of no area. Those beyond six,
  // with their vertex, in its order.
  std::vector<std::array<Index, 6>> six_around_;
  std::vector<std::array<Index, 2>> others_around_;
  Padded twice_area_;  // per number of a triangle: its normal; 0 where it is not shown

  std::map<Index, std::vector<Index>> copies_of_;  // of tetrahedra that a blade has cut
  std::map<Edge, std::vector<Gap>> gaps_;
  std::map<Index, Divided> divided_;
  std::vector<Index> unused_parts_, unused_cut_;  // numbers of parts; places in cut_
  std::vector<CutVertex> cut_;
  std::map<Place, Index> cut_at_;                   // in cut_
  std::vector<std::array<Index, 2>> parts_around_;  // carried vertices with parts, in the vertices' order
  std::uint64_t listed_at_ = 0;                     // the revision of that list
  bool has_new_revision_ = false;                   // in this edit

  Padded mesh_x_, x_;  // scratch of update(): of the mesh; of carried vertices and those of blades
};

}  // namespace lobe
