// Two meshes of one body laid over each other: where the points of one lie in the other.
#pragma once

#include <functional>

#include "lobe/diagnostics/locate.h"

namespace lobe {

struct OverlapPoint {
  Index tet_a = -1, tet_b = -1;
  Eigen::Vector4d at_a, at_b;  // barycentric; outside A, the linear extension of its nearest tetrahedron
  double volume = 0;           // weight of the point [m³]; all of them add up to B's volume
  double outside = 0;          // distance from A [m]; 0 within it, and below a millionth of an edge
};

struct Coverage {
  double outside_fraction = 0;  // share of B's volume that lies outside A
  double largest_gap = 0;       // largest distance of a point of B from A [m]
  double far_fraction = 0;      // share of B's volume further from A than the edge length of A there
};

// Visits the four points of the quadrature of degree two on each tetrahedron of B: an integral over B is
// Σ volume × integrand, exact where the integrand is quadratic on a tetrahedron. O(#B log #A).
Coverage for_each_overlap(const Locator& a, const TetMesh& b,
                          const std::function<void(const OverlapPoint&)>& visit);

// Where each vertex of B lies in A. A point is looked for a millionth of the way towards the barycentre of
// one of its tetrahedra, so that both sides of a cut are told apart. −1: a vertex without tetrahedra.
struct VertexPlace {
  Index tet = -1;
  Eigen::Vector4d at;
};
std::vector<VertexPlace> vertex_places(const Locator& a, const TetMesh& b);

// Σ of barycentric coordinates × values at the corners of a tetrahedron.
Vec3d interpolate(const TetMesh& mesh, const Mat3X<double>& u, Index tet, const Eigen::Vector4d& at);

}  // namespace lobe
