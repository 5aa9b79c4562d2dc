// The order in which a sparse symmetric matrix is factorised, and its supernodes: columns of the factor that
// have the same rows below them. The part of the factor in a supernode is dense.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "lobe/types.h"

namespace lobe {

struct Supernodes {
  std::vector<int> place;               // per component of the matrix: where it comes in the order
  std::vector<int> first = {0};         // per supernode: its first component, in the order; and the end
  std::vector<std::vector<int>> below;  // per supernode: the rows below its diagonal block, in order
  std::vector<int> of;                  // per component, in the order: its supernode

  int count() const { return static_cast<int>(below.size()); }
  int width(int s) const { return first[std::size_t(s) + 1] - first[std::size_t(s)]; }
  int parent(int s) const {  // −1: none
    return below[std::size_t(s)].empty() ? -1 : of[std::size_t(below[std::size_t(s)].front())];
  }
  void number();  // `of`, from `first`
};

// Orders groups of consecutive components with the same neighbours, such as the three of a vertex, by nested
// dissection (METIS). Then it merges supernodes that differ little. `A` is a lower triangle.
Supernodes find_supernodes(const Eigen::SparseMatrix<double>& A);

}  // namespace lobe
