// The linear tensor-mass region ([PDA] section 2.3): one 3 × 3 block per edge end, f_i = −Σ_j K_ij (u_j −
// u_i).
//
// The block of a vertex is minus the sum of those of its edges (a translation costs no energy), so that only
// the edges' are stored, and a translation gives no force to the last bit. Both ends of an edge store its block,
// so that each vertex sums its own row, in order, whatever thread it is on.
#pragma once

#include <array>

#include "lobe/mesh/vertex_lists.h"
#include "lobe/parallel.h"
#include "lobe/region/elements.h"

namespace lobe {

template <class Real>
class TensorMassRegion {
 public:
  // Sums anew the blocks of the edges of an edit, from the tetrahedra that are left around them.
  void follow(const Elements& elements, const RegionEdit& edit);

  Index tet_count() const { return tet_count_; }

  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel) const;
  double energy(const Mat3X<Real>& u) const;  // [J]
  void add_diagonal_stiffness(DiagonalStiffness& K) const;

 private:
  struct Entry {
    std::array<Real, 9> block;  // K_ij [N/m], column by column
    Index vertex = 0;           // j
  };
  void gather_row(const Elements& elements, Index vertex);
  void refresh_edges(const Elements& elements, const std::vector<Index>& removed);
  void set_block(Index vertex, Index other, bool is_edge, const Mat3<double>& block);
  Vec3<Real> force(const Mat3X<Real>& u, Index vertex) const;

  VertexLists<Entry> rows_;
  std::vector<std::uint8_t> member_;  // per tetrahedron
  Index tet_count_ = 0;
};

}  // namespace lobe
