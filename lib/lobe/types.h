// The few types that every folder shares.
//
// Glossary (SI units): X rest position [m], x current position [m], u = x − X displacement [m],
// v velocity [m/s], f force [N] acting ON a vertex, α_j gradient of the barycentric coordinate of vertex j
// [1/m], F = I + Σ u_j ⊗ α_j, E Green-St Venant strain, S second Piola-Kirchhoff stress [Pa],
// λ, μ Lamé coefficients [Pa], κ volume penalty [Pa], ρ density [kg/m³], V rest volume [m³].
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lobe {

using Index = std::int32_t;

template <class Real>
using Vec3 = Eigen::Matrix<Real, 3, 1>;
template <class Real>
using Mat3 = Eigen::Matrix<Real, 3, 3>;
template <class Real>
using Mat34 = Eigen::Matrix<Real, 3, 4>;  // one column per vertex of a tetrahedron
template <class Real>
using Mat3X = Eigen::Matrix<Real, 3, Eigen::Dynamic>;  // one column per vertex
using Vec3d = Vec3<double>;
using Tets = Eigen::Matrix<Index, 4, Eigen::Dynamic>;       // one column per tetrahedron
using Triangles = Eigen::Matrix<Index, 3, Eigen::Dynamic>;  // one column per triangle

}  // namespace lobe
