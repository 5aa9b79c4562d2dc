// Values at the vertices of a part that ranks share.
#pragma once

#include <petscvec.h>

#include "lobe_petsc/part.h"

namespace lobe::petsc {

using Vector = Owned<Vec, VecDestroy>;

// Three numbers per vertex. Those of ghosts come after the owned ones in memory.
class Ghosted {
 public:
  Ghosted(const Ranks& ranks, const Part& part);

  Vec vec() const { return vec_; }  // of the owned vertices

  Mat3X<double> local() const;  // 3 × #local vertices, ghosts as the owners have them
  void set_owned(const Mat3X<double>& local);
  void sum(const Mat3X<double>& local);  // sets the owned ones to the sum over all ranks
  void update_ghosts();                  // copies values from the owners to the ghosts
  std::int64_t ghost_bytes() const {
    return 24 * std::int64_t(ghosts_);
  }  // that update_ghosts() receives here

 private:
  Vector vec_;
  Index owned_, ghosts_;
};

// Per local vertex: whether any rank says so.
std::vector<char> any_rank(Ghosted& scratch, const std::vector<char>& mine);

}  // namespace lobe::petsc
