// Static equilibrium of a body in parts. It uses SNES with the exact tangent, the line search of
// solve/newton.h and the load steps of solve/static_solver.h. Linear systems are solved by conjugate
// gradients with algebraic multigrid, or by MUMPS.
#pragma once

#include <functional>
#include <string>

#include "lobe_petsc/equations.h"

namespace lobe::petsc {

enum class Method { automatic, gamg, hypre, mumps };  // automatic: MUMPS below 50,000 unknowns, else GAMG
inline constexpr const char* method_names[] = {"auto", "gamg", "hypre", "mumps"};
// Throws InputError for a name that is none of these, and for a method that this PETSc was built without.
Method method_of(const std::string& name, const std::vector<std::string>& available);
std::vector<std::string> available_methods();

struct SolverOptions {
  Method method = Method::automatic;
  double tolerance = 1e-10;  // bound of the residual, relative to the loads and reactions
  int most_iterations = 60;  // iterations of Newton's method per load step
  double smallest_load_step = 1e-4;
  std::function<void(const std::string&)> tell;  // one line per Newton iteration, on rank 0
};

struct Seconds {        // wall time, the longest of all ranks
  double assembly = 0;  // time of the tangent
  double setup = 0;     // time of the preconditioner, or of the factor
  double solve = 0;     // time of conjugate gradients, and of all else
  double forces = 0;
};

struct Solution {
  bool converged = false;
  std::string reason;        // why not
  double load_fraction = 0;  // reached in equilibrium
  double residual = 0;       // relative
  Mat3X<double> u;           // 3 × #local vertices [m]
  double energy = 0;         // elastic [J]
  double smallest_volume_ratio = 1;
  int newton_iterations = 0;       // iterations, with those for moves of the boundary
  int linear_iterations = 0;       // iterations of conjugate gradients, in all
  int most_linear_iterations = 0;  // most iterations of one linear system
  int load_steps = 0;
  std::string method;
  double nonzeros = 0;  // entries of the tangent
  std::int64_t unknowns = 0;
  std::int64_t ghost_bytes = 0;  // bytes that this rank receives per product with the tangent
  Seconds seconds;
};

Solution solve_static(const Ranks& ranks, const Part& part, const Setup& setup, const SolverOptions& options);

}  // namespace lobe::petsc
