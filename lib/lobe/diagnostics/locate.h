// In which tetrahedron of a mesh a point lies: a tree of bounding boxes.
#pragma once

#include <Eigen/Geometry>

#include "lobe/mesh/tet_mesh.h"

namespace lobe {

class Locator {
 public:
  // Refers to the mesh, which must outlive it. Throws InputError if the mesh has no tetrahedron. O(#tets log
  // #tets).
  explicit Locator(const TetMesh& mesh);

  struct Found {
    Index tet = -1;
    double distance = 0;  // [m], 0 inside
  };
  // The tetrahedron that contains p, else the nearest one. About O(log #tets); a good guess of the
  // tetrahedron saves most of that.
  Found nearest(const Vec3d& p,  // [m]
                Index guess = -1) const;

  const TetMesh& mesh() const { return mesh_; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    Index begin = 0, end = 0;  // range in tets_
    Index left = -1;           // the right child follows the left one; −1: a leaf
  };
  void split(Index node, const Mat3X<double>& centres);

  const TetMesh& mesh_;
  std::vector<Index> tets_;
  std::vector<Node> nodes_;
};

// Barycentric coordinates of p in a tetrahedron; outside, some are negative: linear extension.
Eigen::Vector4d barycentric(const Mat34<double>& corners, const Vec3d& p);
Eigen::Vector4d barycentric(const TetMesh& mesh, Index tet, const Vec3d& p);

}  // namespace lobe
