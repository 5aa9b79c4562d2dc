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
// If a blade has cut a tetrahedron, vertices and triangles lie on the copies whose grains are under them. The
// skin then opens along the cut: triangles that the cut runs through are hidden.
#pragma once

#include <map>

#include "lobe/io/surface_io.h"
#include "lobe/mesh/slot_log.h"
#include "lobe/mesh/vertex_lists.h"
#include "lobe/scalpel/grains.h"
#include "lobe/skin/carriers.h"

namespace lobe {

// All but positions and normals. A vertex of the file is several here where it has several texture
// coordinates, or several normals: there the skin is creased, as it is in the file.
struct SkinMesh {
  std::uint64_t revision = 0;              // grows by one with each change of what is shown
  std::vector<Eigen::Vector3i> triangles;  // those that are shown; counter-clockwise seen from outside
  std::vector<Index> file_triangle;        // per triangle: its number in the file
  SlotLog changed_triangles;               // as in Surface: arrays without gaps

  std::vector<Index> file_vertex;                   // per vertex; vertices never change
  Eigen::Matrix<float, 2, Eigen::Dynamic> texture;  // 2 × #vertices; 0 where the file has none

  Index vertex_count() const { return static_cast<Index>(file_vertex.size()); }
  Index triangle_count() const { return static_cast<Index>(triangles.size()); }
};

// The boundary of the tetrahedra, for bodies that have no finer surface; its points are all of the mesh.
TexturedSurface textured_boundary(const TetMesh& mesh);

class Skin {
 public:
  // Of the body as it was at the start; both are copied. Throws InputError for a body without tetrahedra or a
  // surface without triangles. O(#triangles log #tets).
  Skin(const TexturedSurface& surface, const TetMesh& mesh);

  // After each edit, which the topology has made. O(what lies on the tetrahedra that are gone, or have other
  // corners). `grains`: World::grains(); null where no blade has cut.
  void follow(const Topology& topology, const MeshEdit& edit, const Grains* grains = nullptr);
  // The same for all edits since the start at once: of a world that was restored, say. O(#triangles).
  void follow_all(const Topology& topology, const Grains* grains = nullptr);

  const SkinMesh& mesh() const { return mesh_; }
  double farthest() const { return farthest_; }  // that a vertex was from its tetrahedron at the start [m]
  // Triangles whose tetrahedra did not hang together at the start, because they are far outside of the body
  // or span a hollow of it. They need not afterwards, and may bridge gaps.
  Index loose_count() const;

  // Positions and unit normals of the vertices: sums of the shown triangles' normals, weighted by area; zero
  // where none is shown. Single precision, for drawing. O(#vertices of skin and mesh), about 10 ns each.
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
  void check(const Topology& topology, std::vector<Index>& triangles, std::vector<Index>& vertices,
             const Grains* grains);
  std::vector<Index> candidates(Index vertex) const;
  // The copies that blades have made of tetrahedra.
  std::span<const Index> elements_under(Index triangle) const;
  void follow_grains(const Topology& topology, std::vector<Index>& cut, const Grains& grains);
  void find_elements_under(Index triangle, const Grains& grains);
  Index nearest_element(std::span<const Index> tets, const Vec3d& p, const Grains* grains) const;
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
  std::vector<Eigen::Vector3i> shown_;       // as mesh_.triangles, of carried vertices
  std::vector<Index> slot_of_;               // per triangle of the file; −1: not shown
  std::vector<std::uint8_t> is_loose_;       // per triangle of the file: see loose_count()
  NumberLists lies_on_, lying_on_, around_;  // tets of triangles, triangles of tets and of carried vertices
  std::vector<Index> carrier_, element_;     // per carried vertex: its tetrahedron, and which copy of it
  std::map<Index, std::vector<Index>> copies_of_;       // of tetrahedra that a blade has cut
  std::map<Index, std::vector<Index>> elements_under_;  // of triangles that lie on such
  VertexLists<Index> carried_by_;                       // per tetrahedron: vertices
  std::vector<Eigen::Vector4f> weights_;                // per carried vertex
  std::vector<Eigen::Vector4i> carrier_corners_;        // the same: vertices of the mesh
  // Per carried vertex: six triangles around it; where there are fewer, one of no area. Those beyond six,
  // with their vertex, in its order.
  std::vector<std::array<Index, 6>> six_around_;
  std::vector<std::array<Index, 2>> others_around_;
  Padded twice_area_;  // per triangle of the file: its normal; 0 where it is not shown
  Padded mesh_x_, x_;  // scratch of update(): of the mesh; of the carried vertices
};

}  // namespace lobe
