// Averaged nodal pressure against volumetric locking. A share χ of λ acts on averages of tr E around vertices
// instead of on single non-linear tetrahedra (theory, section 12),
//   W = Σ_T V_T ((1−χ)λ/2 θ_T² + μ tr(E_T²)) + Σ_n χλ/2 V_n θ_n²   [J],
//   θ_T = tr E_T,  V_n = Σ_T∋n V_T/4,  θ_n = Σ_T∋n V_T θ_T/(4V_n).
// The stress of a tetrahedron is S = ((1−χ)λ θ_T + p_T) I + 2μE [Pa] with p_T = ¼ Σ_n∈T p_n,
// p_n = χλ θ_n.
//
// A pressure node n is a vertex together with a material, so pressure may jump between materials. Only
// non-linear tetrahedra take part. Nodes come and go with their tetrahedra; the numbers of those that have
// gone are used again.
#pragma once

#include <span>
#include <vector>

#include "lobe/fem/elements.h"
#include "lobe/mesh/vertex_lists.h"
#include "lobe/parallel.h"

namespace lobe {

class PressureNodes {
 public:
  static constexpr Index none = 0;  // node of the corners that take no part: no volume, no pressure

  PressureNodes() = default;
  explicit PressureNodes(const Elements& elements);  // takes all that is alive

  // Follows tetrahedra that left, then those that entered, as in RegionEdit. O(tetrahedra around them).
  void follow(const Elements& elements, const std::vector<Index>& leave, const std::vector<Index>& enter);

  Index count() const {
    return static_cast<Index>(volume_.size());
  }  // `none` and numbers not in use included
  bool any() const { return count() - static_cast<Index>(unused_.size()) > 1; }
  double volume(Index node) const { return volume_[node]; }  // V_n [m³], 0 where not in use
  double lambda(Index node) const { return lambda_[node]; }  // χλ [Pa]
  std::span<const Index> tets(Index node) const { return tets_of_[node]; }
  Eigen::Vector4i of(Index tet) const {
    return nodes_.col(tet);
  }  // per corner; all `none` if it takes no part

  // Computes p_n = χλ θ_n [Pa] from V_T θ_T [m³] of each tetrahedron; `pressure` has count() entries.
  template <class Real>
  void gather(const std::vector<Real>& volume_strain, std::vector<Real>& pressure, Parallel& parallel) const {
    parallel.for_ranges(count(), 1024, [&](Index begin, Index end) {
      for (Index n = begin; n < end; ++n) {
        Real sum = 0;
        for (Index t : tets_of_[n]) sum += volume_strain[t];
        pressure[n] = static_cast<Real>(scale_[n]) * sum;
      }
    });
  }

  // p_T [Pa] of a tetrahedron, 0 if it takes no part.
  template <class Real>
  Real mean(const std::vector<Real>& pressure, Index tet) const {
    const auto n = nodes_.col(tet);
    return (pressure[n[0]] + pressure[n[1]] + pressure[n[2]] + pressure[n[3]]) / 4;
  }

  // Adds the exact part of the nodes: Σ_n χλ/V_n g⊗g with g = ∂(V_n θ_n)/∂u_i of each vertex i.
  // O(#tetrahedra).
  void add_diagonal_stiffness(
      const Mat3X<double>& slopes,  // 3 × 4 #tetrahedra: column 4T + c is V_T ∂θ_T/∂u of corner c [m²]
      DiagonalStiffness& K) const;

 private:
  Index node_at(Index vertex, std::uint16_t material, double lambda);
  void update(const Elements& elements, Index node);

  VertexLists<Index> nodes_at_;  // nodes at each vertex, one per material
  VertexLists<Index> tets_of_{std::vector<Index>{0}};
  std::vector<Index> vertex_{-1}, unused_;
  std::vector<std::uint16_t> material_{0};
  std::vector<double> volume_{0}, lambda_{0}, scale_{0};  // scale: χλ/4V_n [Pa/m³]
  Tets nodes_;                                            // 4 × #tetrahedra
};

// p_T [Pa] of every tetrahedron, 0 where it takes no part. O(#tetrahedra).
std::vector<double> tet_pressures(const Elements& elements, const PressureNodes& nodes,
                                  const Mat3X<double>& u);  // 3 × #vertices [m]

}  // namespace lobe
