// lobe bench accuracy: run time against error, over models, precisions, meshes and time steps.
#pragma once

#include "benchmarks/accuracy_cases.h"

namespace lobe::bench {

struct AccuracyRow {
  std::string scene, model, precision;
  double safety = 0;  // of the time step
  int threads = 1;
  Index tets = 0;
  double linear_fraction = 0;  // of the volume
  bool to_the_end = true;      // false: times and errors mean nothing
  std::string status;
  double dt = 0;          // mean time step [s]
  double wall_per_s = 0;  // [s] per simulated second
  double error_model =
      0;  // against all non-linear, in double precision, with small steps, on the same mesh; 3 digits
  double error_total = 0;  // against that on the largest mesh, refined once
  bool has_total = false;
  bool pareto = false;                // of its scene: no other row is both faster and closer to the reference
  double model_reference_change = 0;  // when the reference's steps were halved last
  double total_reference_change = 0;
};

struct Accuracy {
  std::vector<AccuracyRow> rows;
  std::vector<std::string> warnings;  // one line each
};

// Plays one scene in all ways, after two references per mesh and two on the fine one. `show` is called with
// each row as soon as it is there. Without `in_double` only single precision is played. Throws InputError;
// WrongResult if a reference does not run to its end.
Accuracy measure_accuracy(const Case& scene, int threads, void (*show)(const AccuracyRow&) = nullptr,
                          bool in_double = true);

void mark_pareto(std::vector<AccuracyRow>& rows);
std::string accuracy_csv(const std::vector<AccuracyRow>& rows);
std::string accuracy_plot(const std::vector<AccuracyRow>& rows);  // gnuplot

}  // namespace lobe::bench
