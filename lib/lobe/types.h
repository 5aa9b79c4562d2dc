// The few types that every folder shares.
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
