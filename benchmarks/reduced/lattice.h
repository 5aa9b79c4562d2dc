// The cubic lattice in which the vertices of a smooth part of a body are embedded. A vertex that is embedded
// has no displacement of its own: it is interpolated, u_i = Σ_n w_in q_n, with the eight trilinear functions
// of one cell.
#pragma once

#include <array>
#include <vector>

#include "lobe/fem/elements.h"

namespace lobe::reduced {

struct Lattice {
  double spacing = 0;                       // h [m]
  std::vector<std::array<Index, 8>> nodes;  // per cell; node k is at the ends ±1 that the bits of k choose
  std::vector<Vec3d> centres;               // per cell [m]
  std::vector<std::vector<Index>> tets;     // per cell: those whose centroid is in it
  std::vector<Index> cell_of_tet;           // none of the mesh is without
  std::vector<Index> cell_of_vertex;  // the cell it lies in, or where that is empty one of its tetrahedra's
  std::vector<std::array<double, 8>> weights;  // w_in per vertex, of the nodes of its cell; they sum to 1
  Index node_count = 0;

  Vec3d local(Index cell, const Vec3d& X) const { return (X - centres[cell]) * (2 / spacing); }  // ξ, −1…1
};

// Cells of which less than `least_fill` are full go to the fullest neighbour. Cells that no centroid is in are left out. A vertex in one of these is extrapolated from a cell that one of
// its tetrahedra is in, so that affine displacements are exact everywhere.
Lattice make_lattice(const Elements& elements, double spacing, double least_fill = 0.1);

// The eight functions 1, ξ, η, ζ, ηζ, ζξ, ξη, ξηζ at ξ. A trilinear displacement is Σ_m c_m φ_m with
// c_m = ⅛ Σ_n sign(m, n) q_n: those of the nodes are their sums with other signs.
std::array<double, 8> trilinear_functions(const Vec3d& xi);
inline double sign(int function, int node) {
  const double x = node & 1 ? 1 : -1, y = node & 2 ? 1 : -1, z = node & 4 ? 1 : -1;
  const std::array<double, 8> signs{1, x, y, z, y * z, z * x, x * y, x * y * z};
  return signs[std::size_t(function)];
}

}  // namespace lobe::reduced
