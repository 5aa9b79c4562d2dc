// The contact patch: the tetrahedra around what a tool touches, and the stiffness that the tool feels of
// them.
//
// In the time between two models only shear waves from the contact's surroundings matter: c_s T, with
// c_s = √(μ/ρ), about 3 m/s in liver. So the patch is what lies that far from the contact; its rim is taken
// to stand still. The vertices in contact move as one. With the others eliminated first,
//
//   K = K_rr − K_rf K_ff⁻¹ K_fr        r: the contact, as one; f: the free vertices of the patch
//
// K_rr is the stiffness of the contact if no other vertex moves. It is an upper bound.
#pragma once

#include <compare>
#include <functional>
#include <span>
#include <vector>

#include "lobe/body/model.h"
#include "lobe/fem/smoothed_edge.h"

namespace lobe {

struct ContactPatchLimits {
  double reach = 0.026;   // distance from the contact to the patch's rim [m]
  Index most_free = 150;  // vertices; a finer mesh has a smaller patch
};

class ContactPatch {
 public:
  // The tangent ∂²W/∂u² of the patch at displacements(v) [m], in double. Only tetrahedra and their smoothing
  // domains count: nodal pressures, contact and springs are left out. O(tetrahedra of the patch); allocates
  // only while patches grow.
  void gather(const Model& model, std::span<const Index> contact,
              const std::function<Vec3d(Index)>& displacement, const ContactPatchLimits& limits);

  Index free_count() const { return free_; }  // vertices
  // Whether a tetrahedron of the patch, or of one of its domains, is gone or has other corners by now.
  bool is_cut(const Topology& topology) const;

  // The stiffness of the contact while nothing else moves, K_rr [N/m].
  Mat3<double> blocked() const;
  // The stiffness with the patch around it yielding, K [N/m]. O(free_count()³); destroys the patch.
  Mat3<double> condense();

 private:
  void choose_vertices(const Model& model, std::span<const Index> contact, const ContactPatchLimits& limits);
  void add_tet(const Model& model, Index tet, const std::function<Vec3d(Index)>& displacement);
  void find_domains(const Elements& elements);
  void add_domains(const Model& model, const std::function<Vec3d(Index)>& displacement);
  void add_domain(const Elements& elements, const std::function<Vec3d(Index)>& displacement);
  Index row_of(Index vertex) const;  // in K, or none

  struct Domain {
    Index a, b;
    std::uint16_t material;
    RegionModel model;
    auto operator<=>(const Domain&) const = default;
  };

  Eigen::MatrixXd K_;            // lower triangle; the last 3 are the contact
  std::vector<Index> place_;     // number of each vertex of the mesh in K_, contact_ or none
  std::vector<Index> vertices_;  // vertices with a place other than none
  std::vector<Index> tets_;
  std::vector<Eigen::Vector4i> corners_;  // corners of tets_
  std::vector<Domain> domains_;           // domains of which a vertex has a place
  std::vector<Index> around_;             // scratch: tetrahedra of one domain
  SmoothedEdge edge_;                     // scratch: one domain
  Index free_ = 0;
};

// Returns the symmetric part of K with its eigenvalues clamped to 0 … `highest` [N/m].
Mat3<double> clamped(const Mat3<double>& K, double highest);
// Symmetric, and between `least` and `most` times a symmetric A ≥ 0 in each direction: the eigenvalues of
// the pencil (K, A) are clamped.
Mat3<double> clamped_to(const Mat3<double>& K, const Mat3<double>& A, double least, double most);
double highest_eigenvalue(const Mat3<double>& K);

// The shear speed √(μ/ρ) of a tetrahedron [m/s].
double shear_speed(const Elements& elements, Index tet);

}  // namespace lobe
