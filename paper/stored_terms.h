// The paper's non-linear tensor-mass model ([PDA] section 3.2, table 1): the SVK force as a polynomial whose
// coefficients are stored on vertices, edges, triangles and tetrahedra. About 80 numbers per tetrahedron.
//
// Each patch has terms of its own (patch_layout.h). An edge that several patches share has terms in each of
// them, from the tetrahedra there. The polynomial takes displacements, not their differences. A translation
// changes nothing, so each patch takes displacements relative to its first vertex. If cuts have divided a
// patch, each part does so. A part that turns far still loses digits: its rounding error grows as
// (|u|/edge)³, with |u| the displacement of its vertices relative to each other.
#pragma once

#include "lobe/region/patch_sums.h"
#include "paper/term_kernels.h"

namespace lobe {

template <class Real>
class StoredTerms {
 public:
  explicit StoredTerms(InstructionSet set = chosen_instruction_set()) : kernels_(term_kernels<Real>(set)) {}

  // Computes the terms of all patches that an edit changes again, at O(its tetrahedra) for each.
  void follow(const Elements& elements, const std::vector<Index>& leave, const std::vector<Index>& enter,
              RegionModel model = RegionModel::nonlinear);
  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel);
  template <class Visit>  // visit(layout, sums)
  void visit_patches(Visit&& visit) {
    visit(layout_, sums_);
  }
  std::size_t bytes() const;  // of coefficients and the vertices they belong to

 private:
  // Vertices of a patch, as it numbers them, whose tetrahedra are connected within it. Ascending.
  using Part = std::vector<std::uint8_t>;
  template <class Terms>
  using Blocks = std::vector<TermBlock<Real, Terms>>;
  struct Patch {
    Blocks<VertexTerms> vertices;
    Blocks<EdgeTerms> edges;
    Blocks<TriangleTerms> triangles;
    Blocks<TetTerms> tets;
    std::vector<Part> parts;
  };
  using Layout = PatchLayout<4>;
  void gather(const Elements& elements, Index p);
  std::vector<Part> parts_of(Index p) const;

  TermKernels<Real> kernels_;
  Layout layout_;
  std::vector<std::array<std::uint8_t, 4>> corners_;  // per slot, as its patch numbers them
  std::vector<Patch> patches_;
  PatchSums<Real> sums_;
};

}  // namespace lobe
