#include "benchmarks/benchmarks.h"

namespace lobe::bench {

std::span<const Benchmark> all_benchmarks() {
  static constexpr Benchmark list[] = {
      {"kernels", "cost per tetrahedron of each force kernel, against a plain loop", bench_kernels},
      {"accuracy", "run time against error of models, precisions, meshes and time steps", bench_accuracy,
       true, true},
      {"validation", "known solutions, orders of convergence, conserved quantities", bench_validation},
      {"cut", "cost of removing a tetrahedron, against building the model anew", bench_cut},
      {"scalpel", "cost of a blade, the time step that it leaves, statics of a slit beam", bench_scalpel,
       true},
      {"hybrid", "a step with a pre-computed or tensor-mass part, against all non-linear", bench_hybrid, true,
       true},
      {"realtime", "whole gestures, all non-linear, against the clock; what the time step gains",
       bench_realtime, true, true},
      {"surface", "what it costs to follow cuts with the surface, and to draw it", bench_surface},
      {"skin", "a fine textured surface: cost per frame, and at a cut", bench_skin},
      {"contact", "what contact costs per step, far and touching, and does to the time step limit",
       bench_contact},
      {"palpation", "what a finger feels over a tumour, beside it and without it", bench_palpation},
      {"live", "what a session costs beside its frames; a replay of minutes of random hands", bench_live},
      {"haptic", "forces between frames against frames of 1 ms; how punctual a loop at 1 kHz is",
       bench_haptic, true},
      {"elements", "error and cost of plain and edge-smoothed tetrahedra on the same mesh", bench_elements,
       true},
      {"features", "what each option costs per step, on and off", bench_features},
      {"steps", "two ways of shorter steps for stiff parts, against one step for all", bench_steps},
      {"own_steps", "what own steps of soft parts spare beside a stiff one", bench_own_steps},
      {"own_pairs", "own steps of 200 pairs of bodies: whether their energy grows", bench_own_pairs},
      {"stress", "abuse that a body must survive, with a verdict each", bench_stress},
      {"huge", "static solutions of millions of tetrahedra in parts (lobe-petsc, MPI)", bench_huge},
      {"soak", "sessions of a million frames, then random gestures, invariants checked every second",
       bench_soak},
  };
  return list;
}

}  // namespace lobe::bench
