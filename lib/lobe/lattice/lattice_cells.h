// Evaluates the cells of a lattice (embedding.h): a register's width of them at a time, in single precision
// 27 to 30 ns per cell. Forces are found cell by cell and summed node by node, in a fixed order.
#pragma once

#include "lobe/lattice/cell_kernels.h"
#include "lobe/lattice/embedding.h"
#include "lobe/parallel.h"

namespace lobe {

template <class Real>
class LatticeCells {
 public:
  explicit LatticeCells(InstructionSet set = chosen_instruction_set()) : kernels_(cell_kernels<Real>(set)) {}

  void build(const Elements& elements, const Lattice& lattice, const std::vector<LatticeCell>& cells);

  void find_forces(const Mat3X<Real>& q, Parallel& parallel);  // q: 3 × #nodes [m]
  Vec3<Real> force(Index node) const;                          // force found last [N]

  double energy(const Mat3X<Real>& q) const;  // [J]
  struct Smallest {
    double volume_ratio = 1;  // det F
    Index tet = -1;           // a tetrahedron of the cell
  };
  Smallest add_bounds(const Mat3X<Real>& q, std::vector<double>& bounds);  // embedding.h

 private:
  struct Cell {
    LatticeCell cell;
    Lattice::Part part;
    Law<double> law;
    std::size_t slot;  // block by block, lane by lane
  };
  CellArrays<Real> at(const Mat3X<Real>& q);  // q: 3 × #nodes [m]
  Mat3<double> gradient(const Cell& data, const Mat3X<Real>& q) const;
  Index place(std::size_t slot, int corner) const;

  CellKernels<Real> kernels_;
  std::vector<Cell> cells_;
  std::vector<CellBlock<Real>> blocks_;
  std::vector<Law<Real>> laws_;               // law of each block
  std::vector<Index> places_begin_, places_;  // places of each node's forces
  std::vector<PaddedVector<Real>> q_, forces_;
};

extern template class LatticeCells<float>;
extern template class LatticeCells<double>;

}  // namespace lobe
