// The boundary of the body, for drawing and contact: faces of tetrahedra, or of the grains that a blade has
// made of them (scalpel/grain_cells.h). Where a cut meets the outer surface or another stroke's cut there is
// a crease: a point with several kinds of faces around it is a vertex of each, with a normal of its own.
//
// Arrays have no gaps, so that one call can draw an index buffer. New entries take the slots of removed ones.
// If more are removed than added, the last entries move into the gaps. All others keep their slots. So an
// edit changes O(edit) slots. SlotLog tells which, and a copy on a graphics card updates only these. A list
// of free slots would change no fewer, and every reader would have to skip the gaps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "lobe/mesh/slot_log.h"
#include "lobe/mesh/surface_cells.h"

namespace lobe {

enum class RegionModel : std::uint8_t;  // fem/body.h

// What a triangle has of its tetrahedron.
struct TetTags {
  TetTags(const std::vector<RegionModel>& regions) : region_of(regions) {}  // tags of a mesh of one body
  TetTags(std::span<const RegionModel> regions, const MeshBodies& mesh_bodies)
      : region_of(regions), bodies(&mesh_bodies) {}

  RegionModel region(Index tet) const { return region_of[std::size_t(tet)]; }
  std::uint8_t body(Index tet) const { return bodies ? std::uint8_t(bodies->body_of(tet)) : std::uint8_t(0); }

  std::span<const RegionModel> region_of;  // model of each tetrahedron
  const MeshBodies* bodies = nullptr;      // null: there is one body
};

// The face that a triangle is. `code` tells the faces of one tetrahedron apart and has no other meaning.
struct FaceOwner {
  Index tet = -1;
  std::uint32_t code = 0;
  bool operator==(const FaceOwner&) const = default;
};

// All but positions: what stays the same from frame to frame while nothing is cut.
struct SurfaceMesh {
  std::uint64_t revision = 0;  // grows by one with each change of anything here

  // One per triangle.
  std::vector<Eigen::Vector3i> triangles;  // vertices of the surface, counter-clockwise seen from outside
  std::vector<FaceOwner> owner;
  std::vector<RegionModel> region;  // region of its tetrahedron
  std::vector<std::uint8_t> body;   // body of its tetrahedron (MeshBodies); 0 where there is one
  std::vector<std::uint8_t> cut;    // 0: skin; faces that were inside at the start: 1: cut, 2: burnt

  // One per vertex of the surface.
  std::vector<Index> mesh_vertex;        // vertex of the mesh, or the nearest one, see below
  std::vector<std::uint8_t> vertex_cut;  // 1: of cut faces, 0: of skin

  // The vertices of the surface that are no vertices of the mesh, because a blade has cut between those. In
  // no particular order.
  struct Within {
    Index vertex;             // vertex of the surface
    Eigen::Vector4i corners;  // vertices of the mesh
    Eigen::Vector4d weights;  // barycentric weights
  };
  std::vector<Within> within;

  SlotLog changed_triangles, changed_vertices;  // slots of the arrays above

  Index triangle_count() const { return static_cast<Index>(triangles.size()); }
  Index vertex_count() const { return static_cast<Index>(mesh_vertex.size()); }
  Eigen::Map<const Triangles> triangle_columns() const {  // 3 × #triangles
    return {triangles.empty() ? nullptr : triangles.data()->data(), 3, Eigen::Index(triangles.size())};
  }
};

class Surface {
 public:
  Surface() = default;  // an empty surface until it is rebuilt
  // The body may have been cut before. What was inside at the start then follows from the tetrahedra that are
  // gone. O(#tets), and O(n log n) in the number of these.
  Surface(const Topology& topology, const TetTags& tags) { rebuild(topology, tags); }
  Surface(const SurfaceCells& cells, const TetTags& tags) { rebuild(cells, tags); }

  // Rebuilds a surface that has readers: the revision goes on, and everything changes.
  void rebuild(const Topology& topology, const TetTags& tags);
  void rebuild(const SurfaceCells& cells, const TetTags& tags);

  // Call it after each edit, which the topology has made. O(#tetrahedra around the vertices of the removed
  // ones).
  void follow(const Topology& topology, const MeshEdit& edit, const TetTags& tags);
  // Follows cells of any kind: they may be gone, or have other points, neighbours or tetrahedra. The kind is
  // that of rebuild(). O(#them).
  void follow(const SurfaceCells& cells, std::vector<Index> changed, const TetTags& tags);
  // Call it when these tetrahedra may have changed their region. O(#them).
  void follow_regions(const SurfaceCells& cells, std::span<const Index> tets,
                      std::span<const RegionModel> region_of);

  const SurfaceMesh& mesh() const { return mesh_; }
  std::uint64_t revision() const { return mesh_.revision; }

  // Where a face is in the arrays of mesh(); −1: nowhere.
  Index triangle_of(const FaceOwner& face) const;
  // Returns the vertex of the surface at a point of the cells: on the skin, or on a stroke's cut. Stroke −1:
  // a cut that no blade has made. −1: there is none.
  Index vertex_of(Index point, bool cut, Index stroke = -1) const;
  Index point_of(Index vertex) const { return point_of_[vertex]; }

 private:
  using Kind = Index;  // kind of a face: skin, the stroke that has opened it, or burnt: opened otherwise
  static constexpr Kind burnt = -1, skin = -2;
  // A face that is new, or whose corners are.
  struct Face {
    FaceOwner owner;
    Index code = -1;      // 4 × cell + face
    Index triangle = -1;  // slot of the triangle
    Kind kind = burnt;
    bool is_burnt = false;  // whether what was behind it is gone
    Eigen::Vector3i points;
    Eigen::Vector3i vertices = Eigen::Vector3i::Constant(-1);
  };
  Face face_of(Index code, const SurfaceCells::Cell& cell) const;
  Index code_of(const FaceOwner& owner) const;

  static void find_kind(const SurfaceCells& cells, std::uint8_t was, Face& face);
  Index& vertex_in_list(Index point, Kind kind);
  void clear(const SurfaceCells& cells);
  void begin_revision();
  void release(Index triangle);
  void drop(Index code);
  void find_changed(const SurfaceCells& cells, Index cell);
  bool stays(const Face& face) const;
  void keep_vertices();
  void forget_unused();
  Index vertex_for(const SurfaceCells& cells, Index point, Kind kind);
  void put(Index vertex, const SurfacePlace& place);
  void take_out(Index vertex);
  void find_places_anew(const SurfaceCells& cells, std::span<const Index> changed);
  void place(const SurfaceCells& cells, Face& face, const TetTags& tags);
  void move_triangle(Index to);
  void move_vertex(const SurfaceCells& cells, Index to);
  void close_gaps(const SurfaceCells& cells);

  SurfaceMesh mesh_;
  bool of_tets_ = true;
  std::vector<Index> point_of_;     // point of the cells, per vertex
  std::vector<Index> within_of_;    // place in mesh_.within, per vertex; −1: none
  std::vector<Index> uses_;         // corners of triangles at each vertex
  std::vector<Index> triangle_of_;  // triangles of the four faces of each cell
  std::vector<Index> first_of_;     // first vertex of each point
  std::vector<Index> next_of_;      // next vertex of the same point; −1: it is the last
  std::vector<Kind> kind_of_;       // kind of the faces around each vertex

  // Scratch of an edit.
  std::vector<Face> faces_;
  std::vector<Index> corners_, near_;
  std::vector<Index> free_triangles_, unused_;  // free places, in descending order
};

// Positions x = X + u of the surface's vertices. O(#vertices).
template <class Real>
void update_positions(const SurfaceMesh& surface,
                      const Eigen::Ref<const Mat3X<double>>& X,                      // 3 × #mesh [m]
                      const Eigen::Ref<const Mat3X<std::type_identity_t<Real>>>& u,  // 3 × #mesh [m]
                      Mat3X<Real>& x);                                               // out [m]

// Takes values at the mesh's vertices to the surface's vertices. O(#vertices).
template <class Real>
Mat3X<Real> at_surface(const SurfaceMesh& surface, const Eigen::Ref<const Mat3X<Real>>& values);

// Unit normals of the surface's vertices, outwards: the sum of the normals of the triangles around each,
// weighted by area; zero where these have none. O(#triangles).
template <class Real>
void update_normals(const SurfaceMesh& surface, const Mat3X<Real>& x, Mat3X<Real>& normals);

// The volume inside a closed surface, by the divergence theorem: Σ det[a, b, c] / 6 [m³].
double enclosed_volume(const SurfaceMesh& surface, const Mat3X<double>& x);  // 3 × #vertices [m]

}  // namespace lobe
