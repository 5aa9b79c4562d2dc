// The linear tensor-mass region ([PDA] section 2.3): one 3 × 3 block per edge, f_i = −Σ_j K_ij (u_j − u_i).
// Edge-smoothed tetrahedra couple three times as many pairs of vertices. They have no blocks: their domains
// are evaluated with the linear law (smoothed_patches.h).
//
// The block of a vertex is minus the sum of those of its edges, because a translation costs no energy. So
// only the blocks of edges are stored, and a translation gives exactly no force. Each edge is stored once and
// acts on both its ends, K_ji = K_ijᵀ. Edges are grouped in patches (patch_layout.h, patch_sums.h).
#pragma once

#include "lobe/fem/elements.h"
#include "lobe/region/patch_sums.h"
#include "lobe/region/smoothed_patches.h"
#include "lobe/region/wide_kernels.h"

namespace lobe {

template <class Real>
class TensorMassRegion {
 public:
  static constexpr RegionModel model = RegionModel::tensor_mass;

  explicit TensorMassRegion(InstructionSet set = chosen_instruction_set())
      : kernels_(wide_kernels<Real>(set)), smoothed_(set, Strain::small) {}

  // Sums again the blocks of the edges of an edit, from the tetrahedra that are left around them.
  void follow(const Elements& elements, const RegionEdit& edit);

  Index tet_count() const { return tet_count_; }  // number of plain ones
  Index edge_count() const { return layout_.item_count(); }

  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel);
  template <class Visit>  // visit(layout, sums)
  void visit_patches(Visit&& visit) {
    visit(layout_, sums_);
    smoothed_.visit_patches(visit);
  }
  double energy(const Mat3X<Real>& u);  // [J]
  // The smallest det F is not found: the model does not depend on it.
  SmallestVolumeRatio add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K, Parallel& parallel);

 private:
  using Layout = PatchLayout<2>;
  using Ends = Layout::Corners;  // ascending
  using Block = EdgeBlock<Real>;
  static constexpr int width = Block::width, patch_blocks = Layout::capacity / width;

  struct Neighbour {
    Index vertex, edge;
  };

  std::vector<Index> update_members(const Elements& elements, const RegionEdit& edit);
  std::vector<Ends> touched_edges(const Elements& elements, const RegionEdit& edit,
                                  const std::vector<Index>& removed) const;
  Index edge_of(const Ends& ends) const;  // −1 if there is none
  Index add_edge(const Ends& ends);
  void erase_edge(const Ends& ends, Index edge);
  void write_ends(const Layout::Item& item);
  void write(Index edge, const Mat3<Real>& block);
  template <class Visit>
  void for_edges(Visit&& visit) const;

  WideKernels<Real> kernels_;
  Layout layout_;
  std::vector<Block> blocks_;  // patch_blocks per patch
  PatchSums<Real> sums_;
  VertexLists<Neighbour> neighbours_;  // neighbours of higher numbers, per vertex
  std::vector<Index> unused_;          // numbers of edges that are free
  Index edge_numbers_ = 0;             // numbers of edges, in use or not
  std::vector<std::uint8_t> member_;   // flag of each tetrahedron
  Index tet_count_ = 0;
  SmoothedPatches<Real> smoothed_;
};

}  // namespace lobe
