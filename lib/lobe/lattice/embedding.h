// Embedded vertices follow the nodes of a lattice: u_i = Σ_n w_n(X_i) q_n. An Embedding is what follows from
// which vertices are embedded. A reduced tetrahedron of four embedded vertices is part of a cell. Any other
// is full: it is evaluated as it is, and forces on its embedded corners go to the nodes (theory, section 18).
#pragma once

#include "lobe/lattice/lattice.h"

namespace lobe {

using CellMatrix = Eigen::Matrix<double, 8, 8>;

// A part of the lattice with the samples of it whose tetrahedra are not full. With the displacements q_n of
// its nodes
//   F = I + Σ_n q_n ⊗ N_n,   W = V W_law(F) + ½ Σ_nm S_nm q_n·q_m.
// S is the energy of the fluctuation ½ α |F_x − F|², half over the samples and half over the eight Gauss
// points of the cell, which hold nodes that no sample is near. It does not resist a rotation.
struct LatticeCell {
  Index part = 0, tet = 0;                          // tet: of its first sample
  double volume = 0;                                // V [m³]
  CellGradients gradients = CellGradients::Zero();  // N_n [1/m]
  CellMatrix fluctuation = CellMatrix::Zero();      // S_nm [N/m]
};

struct Embedding {
  std::vector<std::uint8_t> is_embedded;  // per vertex
  std::vector<Index> vertices;            // those
  std::vector<Index> interface;           // those of them that are corners of full tetrahedra
  std::vector<Index> full;                // reduced tetrahedra
  std::vector<LatticeCell> cells;         // by material
  std::vector<double> mass;               // per node [kg]; 0: nothing follows it

  bool embeds(Index v) const {
    return v < static_cast<Index>(is_embedded.size()) && is_embedded[std::size_t(v)];
  }
};

// What samples of a part add up to: V, Σ V ∇w and Σ V ∇w ∇wᵀ.
struct CellSums {
  double volume = 0;                                // [m³]
  CellGradients gradients = CellGradients::Zero();  // [m²]
  CellMatrix squares = CellMatrix::Zero();          // [m]
};
std::vector<CellSums> sum_cells(const Elements& elements,
                                const Lattice& lattice);  // per part, of all samples

// α is half of Young's modulus, which is exact for a cube that is bent. `whole`: sum_cells(). Costs a pass
// over the tetrahedra, and a microsecond for each that is full in a part that is not.
Embedding embed(const Elements& elements, const Lattice& lattice, const std::vector<CellSums>& whole,
                std::vector<std::uint8_t> is_embedded);

// Row sums of the mass of the embedded vertices, per vertex [kg]. The lattice alone then has no frequency
// above `omega` [rad/s], the highest of the full body at rest: where it would, mass is added. Returns how
// much [kg].
double give_mass(const Elements& elements, const Lattice& lattice, const std::vector<double>& mass,
                 double omega, Embedding& embedding);

// Adds to a bound of the stiffness of each node, Σ_m |K_nm| [N/m], what a cell adds. `tangents`: per corner,
// its V times the largest eigenvalue of the law's ∂²W/∂q_n² [N/m].
void add_bounds(const LatticeCell& cell, const Lattice::Part& part, const CellWeights& tangents,
                std::vector<double>& bounds);

}  // namespace lobe
