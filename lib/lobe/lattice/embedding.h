// Embedded vertices follow the nodes of a lattice: u_i = Σ_n w_n(X_i) q_n. An Embedding is what follows from
// which vertices are embedded. A reduced tetrahedron of four embedded vertices is part of a cell. Any other
// is full: it is evaluated as it is, and forces on its embedded corners go to the nodes (theory, section 18).
#pragma once

#include "lobe/lattice/lattice.h"

namespace lobe {

using CellMatrix = Eigen::Matrix<double, 8, 8>;

// A part of the lattice, with those of its samples whose tetrahedra are not full. With displacements q_n of
// its nodes
//   F = I + Σ_n q_n ⊗ N_n,   W = V W_law(F) + ½ Σ_nm S_nm q_n·q_m.
// S is the energy of the fluctuation ½ α |F_g − F|² over the eight Gauss points g of the cell, each with an
// eighth of V. It does not resist a rotation.
struct LatticeCell {
  Index part = 0, tet = 0;                          // tet: that of its first sample
  double volume = 0;                                // V [m³]
  CellGradients gradients = CellGradients::Zero();  // N_n [1/m]
  CellMatrix fluctuation = CellMatrix::Zero();      // S_nm [N/m]
};

// What vertices do: they follow nodes, never leave their rest positions, or move by themselves.
struct VertexRoles {
  std::vector<std::uint8_t> is_embedded, is_still;  // flags of vertices; is_still: empty if none is
  bool embeds(Index v) const { return has(is_embedded, v); }
  bool stays(Index v) const { return has(is_still, v); }
  bool operator==(const VertexRoles&) const = default;

 private:
  static bool has(const std::vector<std::uint8_t>& flags, Index v) {
    return v < static_cast<Index>(flags.size()) && flags[std::size_t(v)];
  }
};

// A full tetrahedron whose corners all stay where they are is left out: it has no force on anything.
struct Embedding {
  VertexRoles roles;
  std::vector<Index> vertices;     // embedded ones
  std::vector<Index> interface;    // embedded vertices at full tetrahedra
  std::vector<Index> full;         // reduced tetrahedra
  std::vector<LatticeCell> cells;  // cells, by material
  std::vector<double> mass;        // mass of each node [kg]; 0: nothing follows it

  bool embeds(Index v) const { return roles.embeds(v); }
};

// The sums V and Σ V ∇w over the samples of a part.
struct CellSums {
  double volume = 0;                                // [m³]
  CellGradients gradients = CellGradients::Zero();  // [m²]
};

// What a lattice is while no vertex moves by itself.
struct WholeLattice {
  std::vector<CellSums> sums;     // sums of each part
  std::vector<double> stiffness;  // α of each material [Pa]
};
WholeLattice sum_cells(const Elements& elements, const Lattice& lattice);
// Takes a tetrahedron out of a lattice and of its sums.
void take_out(const Elements& elements, Index tet, Lattice& lattice, WholeLattice& whole);

// Returns α of each material [Pa]. It is chosen so that, in nine modes of a cell, all cells of the material
// together have the energy of their tetrahedra, less the energy of the mean strain. With x from the middle
// of the cell, and a, b, c different axes, the modes are u_a = x_b x_c, and bending with free faces,
// u_a = x_a x_b, u_b = −½ x_a² − ½ λ/(λ + 2μ) x_b². The modes are interpolated from the vertices,
// so α includes the excess stiffness of the mesh. α is at least that of a fine mesh,
// μ/3 (1 + 4 (λ + μ)/(λ + 2μ)).
std::vector<double> fluctuation_stiffness(const Elements& elements, const Lattice& lattice,
                                          const std::vector<CellSums>& sums);

// Returns what follows from `roles`. `whole`: sum_cells(). Costs a pass over the tetrahedra, and half a
// microsecond for each that is full in a part that is not.
Embedding embed(const Elements& elements, const Lattice& lattice, const WholeLattice& whole,
                VertexRoles roles);

// Gives nodes the row sums of the mass of embedded vertices, `mass` per vertex [kg]. Adds mass where a node
// would have a frequency above `omega` [rad/s] at rest. `stiffness`: λ_max(K_vv) per vertex, times the square
// of the highest frequency over that of a single vertex [N/m]. Without it, vertices are taken to have no
// frequency above omega. Returns how much was added [kg].
double give_mass(const Elements& elements, const Lattice& lattice, const std::vector<double>& mass,
                 double omega, const std::vector<double>& stiffness, Embedding& embedding);

// Adds a cell's part to a bound of the stiffness of each node, Σ_m |K_nm| [N/m]. `tangents`: per corner,
// its V times the largest eigenvalue of the law's ∂²W/∂q_n² [N/m].
void add_bounds(const LatticeCell& cell, const Lattice::Part& part, const CellWeights& tangents,
                std::vector<double>& bounds);

}  // namespace lobe
