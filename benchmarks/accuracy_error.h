// The error of a played gesture against a reference, on the reference's mesh.
#pragma once

#include "benchmarks/accuracy_play.h"
#include "lobe/diagnostics/overlap.h"
#include "lobe/setup/setup.h"

namespace lobe::bench {

class ErrorNorm {
 public:
  // Of runs on the reference's own mesh.
  explicit ErrorNorm(const Setup& reference);
  // Of runs on another mesh of the same body: they are interpolated to the reference's vertices. Throws
  // InputError if it is not the same body.
  ErrorNorm(const Setup& reference, const TetMesh& mesh);

  // √(Σ ‖u − u_ref‖²_M / Σ ‖u_ref‖²_M) over the sample times; M: lumped masses of the reference's mesh.
  // Throws InputError if the reference does not move.
  double relative(const Samples& run, const Samples& reference) const;

 private:
  std::vector<double> mass_;  // per vertex of the reference [kg]
  TetMesh mesh_;              // of the run; empty if it is the reference's
  std::vector<VertexPlace> places_;
};

}  // namespace lobe::bench
