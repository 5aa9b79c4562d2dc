// Nodal pressure (nodal_pressure.h) of edge-smoothed tetrahedra: the trace of strain is averaged around
// vertices from that of the domains around them, each with half of its volume:
//   θ_e = tr E_e,   V_n = Σ_{e∋n} ½ V_e,   θ_n = Σ_{e∋n} ½ V_e θ_e / V_n,   p_n = χλ θ_n,
//   W = Σ_e V_e ((1−χ)λ/2 θ_e² + μ tr E_e²) + Σ_n χλ/2 V_n θ_n²,
// so that a domain has the pressure p_e = ½ (p_a + p_b) of both ends of its edge. A node is a pair (vertex,
// material). V_n is a quarter of the volume of the tetrahedra around n, since three edges of each meet there.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lobe/parallel.h"
#include "lobe/region/smoothed_edges.h"

namespace lobe {

class EdgePressures {
 public:
  static constexpr Index none = 0;  // node of domains that take no part: no volume, no pressure

  EdgePressures() = default;
  EdgePressures(const Elements& elements, const SmoothedEdges& edges);  // takes all domains

  // Follows domains that are new, have changed or are gone.
  void follow(const Elements& elements, const SmoothedEdges& edges, const std::vector<Index>& changed);

  Index count() const {
    return static_cast<Index>(volume_.size());
  }  // `none` and numbers not in use included
  bool any() const { return count() - static_cast<Index>(unused_.size()) > 1; }
  double volume(Index node) const { return volume_[node]; }  // V_n [m³], 0 where not in use
  double lambda(Index node) const { return lambda_[node]; }  // χλ [Pa]
  const std::array<Index, 2>& of(Index edge) const {
    return nodes_[edge];
  }  // the nodes of both ends; `none` if the edge takes no part

  // Computes p_n [Pa] from V_e θ_e [m³] of each domain; `pressure` has count() entries.
  template <class Real>
  void gather(const std::vector<Real>& volume_strain, std::vector<Real>& pressure, Parallel& parallel) const {
    parallel.for_ranges(count(), 1024, [&](Index begin, Index end) {
      for (Index n = begin; n < end; ++n) {
        Real sum = 0;
        for (Index e : edges_of_[n]) sum += volume_strain[e];
        pressure[n] = static_cast<Real>(scale_[n]) * sum;
      }
    });
  }
  MaterialLaw law_of(Index edge) const { return laws_[edge]; }
  // p_e [Pa], 0 if it takes no part.
  template <class Real>
  Real mean(const std::vector<Real>& pressure, Index edge) const {
    return (pressure[nodes_[edge][0]] + pressure[nodes_[edge][1]]) / 2;
  }

  // Adds the exact part of the nodes: Σ_n χλ/V_n g⊗g with g = ∂(V_n θ_n)/∂u_i = Σ_{e∋n} ½ V_e ∂θ_e/∂F b_ei of
  // each vertex i. `gradients`: ∇u per domain. O(#domains).
  void add_diagonal_stiffness(const SmoothedEdges& edges, const std::vector<Mat3<double>>& gradients,
                              DiagonalStiffness& K) const;

 private:
  Index node_at(Index vertex, const SmoothedEdge& edge, double lambda);
  void update(const SmoothedEdges& edges, Index node);

  VertexLists<Index> nodes_at_;  // nodes at each vertex, one per material
  VertexLists<Index> edges_of_{std::vector<Index>{0}};
  std::vector<Index> vertex_{-1}, unused_;
  std::vector<std::uint16_t> material_{0};
  std::vector<double> volume_{0}, lambda_{0}, scale_{0};  // scale: χλ/2V_n [Pa/m³]
  std::vector<std::array<Index, 2>> nodes_;               // nodes of each domain
  std::vector<MaterialLaw> laws_;                         // law of each domain
};

// p_e [Pa] of every domain, 0 where it takes no part. O(#domains).
std::vector<double> domain_pressures(const SmoothedEdges& edges, const EdgePressures& pressures,
                                     const std::vector<Mat3<double>>& gradients);  // ∇u per domain
std::vector<Mat3<double>> domain_gradients(const SmoothedEdges& edges,
                                           const Mat3X<double>& u);  // 3 × #vertices [m]

}  // namespace lobe
