// The static equations of a body in parts: forces, energy and the exact tangent. Each rank computes those of
// its own tetrahedra.
#pragma once

#include <petscmat.h>

#include "lobe/solve/tangent.h"
#include "lobe_petsc/held_pieces.h"

namespace lobe::petsc {

struct State {
  double potential = 0;              // [J]
  double elastic = 0;                // [J], of that
  double residual = 0, scale = 0;    // norms of the unbalanced forces, and of what they are the sum of [N]
  double smallest_volume_ratio = 1;  // det F, over the non-linear region
};

class Equations {
 public:
  // Throws InputError on all ranks for a setup without an equilibrium.
  Equations(const Ranks& ranks, const Part& part, const Setup& setup);

  const Elements& elements() const { return elements_; }
  const Ghosted& vertices() const { return u_; }
  std::int64_t unknowns() const { return unknowns_; }
  bool is_linear() const { return is_linear_; }
  std::int64_t ghost_bytes() const { return u_.ghost_bytes(); }

  // u: three displacements per owned vertex [m]. Forces: loads × fraction − ∂W/∂u, zero where displacements
  // are given [N].
  State at(Vec u, double fraction, Vec forces);
  double smallest_volume_ratio(Vec u);
  Mat3X<double> local(Vec u);  // 3 × #local vertices [m]

  // A matrix of 3 × 3 blocks, with the rigid motions as near-null space. Rows and columns of given components
  // have their diagonal entry only.
  Owned<Mat, MatDestroy> make_matrix();
  void tangent(Vec u, Mat matrix);
  // forces −= ∂²W/∂u² w, for a displacement w of given components.
  void subtract_product(Vec u, Vec w, Vec forces);
  void clear_prescribed(Vec w);  // zero where displacements are given
  // Computes what is still missing to a fraction of the prescribed displacements; zero where nothing is given
  // [m].
  void boundary_move(Vec u, double fraction, Vec move);

 private:
  void reserve(Mat matrix);
  void add_loads(const Setup& setup);

  const Ranks& ranks_;
  const Part& part_;
  Elements elements_;
  Averages averages_;  // none
  Ghosted u_, sums_;
  PrescribedComponents is_prescribed_;
  Mat3X<double> prescribed_, loads_;  // values of owned vertices at full load [m], [N]
  std::int64_t unknowns_ = 0;
  bool is_linear_ = false;
};

}  // namespace lobe::petsc
