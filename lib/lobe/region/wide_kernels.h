// The loops that are compiled once per instruction set (wide_kernels.cpp). They take plain arrays and share
// no inline function with the rest of the library. Otherwise the linker might keep a copy of that function
// that an older processor cannot run.
#pragma once

#include "lobe/fem/law_moduli.h"
#include "lobe/instruction_set.h"
#include "lobe/region/element_block.h"

namespace lobe {

// What the kernel does with the guard of the law: leaves it out (off), leaves it out and returns the smallest
// det F (asked), or evaluates it (acting).
enum class Guarding { off, asked, acting };

enum class StiffnessPart { diagonal, off_diagonal };  // xx, yy, zz; xy, xz, yz

template <class Real>
struct PatchArrays {  // one patch: all its tetrahedra are of one material
  const ElementBlock<Real>* blocks;
  Index block_count;
  const PressureBlock<Real>* pressure_blocks;  // null without nodal pressure
  const Real* pressure;                        // pressure of each node [Pa]
  const PaddedVector<Real>* u;                 // displacement of each vertex of the patch [m]
  const FibreBlock<Real>* fibre_blocks;        // null where no material has fibres
  Law<Real> law;                               // law without its pressure and direction
};

template <class Real>
struct WideKernels {
  // Adds the forces of the patch's tetrahedra to those of its vertices [N], tetrahedron by tetrahedron.
  // Returns the smallest det F if asked, to rounding, else 1.
  Real (*add_forces)(const PatchArrays<Real>& patch, Guarding guarding, PaddedVector<Real>* f);
  void (*volume_strains)(const PatchArrays<Real>& patch, Real* rows);  // V θ [m³], block by block
  // Adds three of the six entries of the stiffness that each vertex feels when it moves while its neighbours
  // are held [N/m]. Returns the smallest det F.
  Real (*add_stiffness)(const PatchArrays<Real>& patch, StiffnessPart part, PaddedVector<Real>* K);
  // Adds the forces of the edges of a linear patch, which has `count` blocks, edge by edge.
  void (*add_edge_forces)(const EdgeBlock<Real>* blocks, Index count, const PaddedVector<Real>* u,
                          PaddedVector<Real>* f);
};

template <class Real>
WideKernels<Real> wide_kernels(InstructionSet set);  // `set`: an available one

}  // namespace lobe
