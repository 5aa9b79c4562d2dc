// Edge-smoothed tetrahedra: the deformation gradient is averaged around each edge before the law is
// evaluated (Z. C. He et al., An edge-based smoothed tetrahedron finite element method (ES-T-FEM) for 3D
// static and dynamic problems, Comput. Mech. 52, 2013). The smoothing domain of an edge e has a sixth of
// each tetrahedron T that contains it,
//   V_e = Σ V_T/6,   F_e = Σ V_T/6 F_T / V_e = I + Σ_j u_j ⊗ b_j,   b_j = Σ V_T/6 α_Tj / V_e,
//   W = Σ_e V_e ψ(F_e),   f_j = −Σ_e V_e P(F_e) b_j.
// So a domain is an element of all vertices of its tetrahedra, with b_j for α_j. A lone tetrahedron has six
// domains of the same F and is the plain one.
#pragma once

#include <span>
#include <vector>

#include "lobe/fem/elements.h"

namespace lobe {

struct SmoothedEdge {
  std::vector<Index> vertices;      // both ends, then the other vertices of its tetrahedra
  std::vector<Vec3d> gradients;     // b_j [1/m], one per vertex; they sum to zero
  double volume = 0;                // V_e [m³]; 0: the edge has no tetrahedron
  Vec3d direction = Vec3d::Zero();  // principal direction of its tetrahedra's fibres
  std::uint16_t material = 0;
  RegionModel model = RegionModel::nonlinear;  // model of its tetrahedra
};

// Computes the domain of the edge (a, b) from its tetrahedra, which are of one material and one model.
void find_smoothed_edge(const Elements& elements, Index a, Index b, std::span<const Index> tets,
                        SmoothedEdge& edge);

// ∇u of the domain, from differences to the first vertex, so that a translation gives exactly zero.
template <class Real>
Mat3<double> displacement_gradient(const SmoothedEdge& edge,
                                   const Mat3X<Real>& u) {  // 3 × #vertices of the body [m]
  Mat3<double> H = Mat3<double>::Zero();
  const Vec3<Real> first = u.col(edge.vertices[0]);
  for (std::size_t j = 1; j < edge.vertices.size(); ++j)
    H += Vec3<Real>(u.col(edge.vertices[j]) - first).template cast<double>() * edge.gradients[j].transpose();
  return H;
}
// −V_e P b_j on each vertex of the domain, 3 × #its vertices [N].
inline Mat3X<double> vertex_forces(const SmoothedEdge& edge, const Mat3<double>& P) {  // [Pa]
  Mat3X<double> f(3, Eigen::Index(edge.vertices.size()));
  for (std::size_t j = 0; j < edge.vertices.size(); ++j)
    f.col(Eigen::Index(j)) = -edge.volume * P * edge.gradients[j];
  return f;
}

// The law of its material, with the direction of its fibres: the linear one (linear_law), or that of its
// model without volume term and guard, which act on each tetrahedron by itself.
Law<double> smoothed_linear_law(const Elements& elements, const SmoothedEdge& edge);
Law<double> smoothed_law(const Elements& elements, const SmoothedEdge& edge,
                         double pressure = 0);  // mean of both ends [Pa]

}  // namespace lobe
