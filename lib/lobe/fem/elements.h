// The rest data that every region reads: the mesh as it is being cut, its materials and its regions.
#pragma once

#include <vector>

#include "lobe/fem/body.h"
#include "lobe/fem/shape.h"
#include "lobe/mesh/topology.h"
#include "lobe/mesh/vertex_columns.h"

namespace lobe {

struct Elements {
  explicit Elements(const Body& body);

  Topology topology;
  VertexColumns<Mat3X<double>> points;  // 3 × topology.vertex_count(), rest positions [m]
  std::vector<int> labels;              // none if all are 0
  MeshBodies bodies;                    // bodies of a mesh of several
  Mat3X<double> fibres;                 // 3 × #tetrahedra, unit vectors at rest; or no column
  std::vector<Elastic> materials;
  std::vector<std::uint16_t> material_of;
  std::vector<RegionModel> region_of;
  std::vector<double> shares;          // φ; none if all tetrahedra are full
  std::vector<double> corner_volumes;  // φV/4 [m³] of each tetrahedron, for lumped_mass() after a cut
  RegionFrame precomputed_frame = RegionFrame::fixed;
  double volume_penalty = 0;  // κ [Pa], of the non-linear region
  double guard_below = 0;     // J₀, of the non-linear region

  Mat34<double> corner_points(Index tet) const {  // [m]
    Mat34<double> X;
    for (int c = 0; c < 4; ++c) X.col(c) = points.col(topology.tets()(c, tet));
    return X;
  }
  // φ: a tetrahedron that a blade has cut becomes two or more copies of the same shape, which share its
  // volume. Integrals over a tetrahedron have the factor φ; quantities at a point in it do not.
  double share_of(Index tet) const { return shares.empty() ? 1 : shares[tet]; }
  double volume(Index tet) const { return share_of(tet) * signed_volume(corner_points(tet)); }  // [m³]
  Shape shape_of(Index tet) const {
    Shape of_whole = shape(corner_points(tet));
    of_whole.volume *= share_of(tet);
    return of_whole;
  }
  // Call it when the topology has made copies or has divided volumes again.
  void follow(const MeshEdit& edit);
  int label_of(Index tet) const { return labels.empty() ? 0 : labels[tet]; }
  bool is_in(RegionModel model, Index tet) const {  // the tetrahedron is alive and of that model
    return topology.alive(tet) && region_of[tet] == model;
  }
  Vec3d fibre_of(Index tet) const { return fibres.cols() == 0 ? Vec3d::Zero() : Vec3d(fibres.col(tet)); }
  const Elastic& elastic_of(Index tet) const { return materials[material_of[tet]]; }
};

// What an edit of the mesh or of the regions' tags means for the regions.
struct RegionEdit {
  std::vector<Index> left;      // tetrahedra that were removed, or changed corners, share or region
  std::vector<Index> entered;   // alive tetrahedra that are new, or changed corners, share or region
  std::vector<Index> vertices;  // all vertices, old and new, of these; sorted
  std::vector<std::pair<Index, Index>> copied;  // vertices and their copies, which start where these were
  std::vector<std::pair<Index, Index>> copied_tets = {};  // tetrahedra and their copies, alike
};

// Upper triangle (xx, xy, xz, yy, yz, zz) of the 3 × 3 stiffness that each vertex feels when it moves while
// its neighbours are held [N/m].
using DiagonalStiffness = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Lumped mass ∫ρ/4 per corner of the alive tetrahedra around one vertex [kg]. [PDA] section 3.2.
double lumped_mass(const Elements& elements, Index vertex);

}  // namespace lobe
