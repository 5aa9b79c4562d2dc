// A tetrahedral mesh at rest, as it is read, written and handed from part to part.
#pragma once

#include <Eigen/LU>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/mesh/mesh_bodies.h"
#include "lobe/types.h"

namespace lobe {

struct TetMesh {
  Mat3X<double> points;     // 3 × #vertices, rest positions [m]
  Tets tets;                // 4 × #tetrahedra, positively oriented: det[X1−X0, X2−X0, X3−X0] > 0
  std::vector<int> labels;  // one per tetrahedron, 0 where the file has none
  Mat3X<double> fibres{};   // 3 × #tetrahedra, unit vectors along the fibres at rest; or no column
  MeshBodies bodies{};      // bodies of a mesh of several (joined_mesh.h)

  Index vertex_count() const { return static_cast<Index>(points.cols()); }
  Index tet_count() const { return static_cast<Index>(tets.cols()); }

  static constexpr auto fields =
      std::tuple(&TetMesh::points, &TetMesh::tets, &TetMesh::fibres, &TetMesh::bodies);
};

// Corners of the face opposite to corner k, counter-clockwise seen from outside.
inline constexpr int face_corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
// The six edges of a tetrahedron as pairs of corners.
inline constexpr int edge_corners[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

Mat34<double> tet_points(const TetMesh& mesh, Index tet);    // 3 × 4 [m]
inline double signed_volume(const Mat34<double>& corners) {  // [m³], positive if well oriented
  const Mat3<double> edges = corners.rightCols<3>().colwise() - corners.col(0);
  return edges.determinant() / 6;
}
double total_volume(const TetMesh& mesh);  // [m³]
struct Box {
  Vec3d min = Vec3d::Zero(), max = Vec3d::Zero();  // [m]
};
Box bounding_box(const TetMesh& mesh);             // box of the vertices that tetrahedra use
Vec3d barycentre(const TetMesh& mesh, Index tet);  // [m]

// What prepare() changed or noticed.
struct PrepareReport {
  Index reoriented = 0;    // tetrahedra whose corners 2 and 3 were swapped
  Index unreferenced = 0;  // vertices that belong to no tetrahedron (kept; they stay at rest)
  std::vector<std::string> warnings() const;
};

// Makes a mesh that was just read safe to use: checks every index and coordinate, orients every
// tetrahedron, fills missing labels with 0. Throws InputError naming the first offenders of each kind:
// indices out of range, a vertex used twice by one tetrahedron, NaN or infinite coordinates, flat
// tetrahedra (smallest altitude below 1e-7 of the longest edge), two tetrahedra with the same four
// vertices, a face shared by three or more tetrahedra, no tetrahedron at all.
// `name` is the mesh's name in messages, usually its file.
PrepareReport prepare(TetMesh& mesh, const std::string& name);

}  // namespace lobe
