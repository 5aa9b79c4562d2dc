#include "lobe_petsc/static_solver.h"

#include <petscsnes.h>

#include <algorithm>
#include <cmath>

#include "lobe/text.h"
#include "lobe_petsc/clock.h"

namespace lobe::petsc {
namespace {

// Sets an option of PETSc, unless the user has set it in PETSC_OPTIONS.
void set_default(const char* name, const char* value) {
  PetscBool is_set = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, name, &is_set));
  if (!is_set) check(PetscOptionsSetValue(nullptr, name, value));
}

constexpr char no_memory[] = "the direct solver has not enough memory";

class Solver {
 public:
  Solver(const Ranks& ranks, const Part& part, const Setup& setup, const SolverOptions& options);
  Solution run();

 private:
  static PetscErrorCode function(SNES, Vec u, Vec forces, void* self);
  static PetscErrorCode jacobian(SNES, Vec u, Mat, Mat, void* self);
  static PetscErrorCode converged(SNES, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason*,
                                  void* self);
  static PetscErrorCode line_search(SNESLineSearch, void* self);

  void choose_method();
  void set_multigrid(bool hypre);
  void assemble(Vec u);
  void grow_workspace();
  bool lacks_workspace() const;
  void count_linear();
  State evaluate(Vec u, Vec forces);
  bool find(double fraction);
  bool follow_boundary();
  bool move_by_linear(Vec move);
  const char* search(Vec u, Vec direction, Vec forces, Vec trial, Vec trial_forces, double& length);
  const char* trouble_of(SNESConvergedReason reason) const;

  const Ranks& ranks_;
  const SolverOptions& options_;
  Solution result_;
  Equations equations_;
  Owned<SNES, SNESDestroy> snes_;
  Owned<Mat, MatDestroy> matrix_;
  Vector u_, forces_, kept_, move_, direction_;
  KSP ksp_ = nullptr;  // of snes_
  bool direct_ = false;
  double fraction_ = 0;
  State state_;
  const char* trouble_ = "";
};

// A C function that calls C++: what it throws becomes an error of PETSC, with its message.
template <class Work>
PetscErrorCode guarded(Work&& work) {
  try {
    work();
    return 0;
  } catch (const std::exception& error) {
    return PetscError(PETSC_COMM_SELF, __LINE__, "callback", __FILE__, PETSC_ERR_LIB, PETSC_ERROR_INITIAL,
                      "%s", error.what());
  }
}

Solver::Solver(const Ranks& ranks, const Part& part, const Setup& setup, const SolverOptions& options)
    : ranks_(ranks), options_(options), equations_(ranks, part, setup), matrix_(equations_.make_matrix()) {
  for (Vector* vec : {&u_, &forces_, &kept_, &move_, &direction_})
    check(VecDuplicate(equations_.vertices().vec(), vec->fill()));
  check(VecSet(u_, 0));
  check(SNESCreate(ranks.comm(), snes_.fill()));
  check(SNESSetFunction(snes_, forces_, function, this));
  check(SNESSetJacobian(snes_, matrix_, matrix_, jacobian, this));
  check(SNESSetConvergenceTest(snes_, converged, this, nullptr));
  check(SNESSetTolerances(snes_, 0, 0, 0, options.most_iterations, 1'000'000));
  SNESLineSearch search = nullptr;
  check(SNESGetLineSearch(snes_, &search));
  check(SNESLineSearchSetType(search, SNESLINESEARCHSHELL));
  check(SNESLineSearchShellSetUserFunc(search, line_search, this));
  check(SNESGetKSP(snes_, &ksp_));
  choose_method();
  MatInfo info;
  check(MatGetInfo(matrix_, MAT_GLOBAL_SUM, &info));
  result_.nonzeros = info.nz_allocated;
  result_.unknowns = equations_.unknowns();
  result_.ghost_bytes = equations_.ghost_bytes();
}

void Solver::choose_method() {
  Method method = options_.method;
  if (method == Method::automatic) {
    const std::vector<std::string> available = available_methods();
    const bool has_mumps = std::find(available.begin(), available.end(), "mumps") != available.end();
    method = has_mumps && equations_.unknowns() < 50'000 ? Method::mumps : Method::gamg;
  }
  result_.method = method_names[int(method)];
  direct_ = method == Method::mumps;
  if (!direct_) return set_multigrid(method == Method::hypre);
  PC pc = nullptr;
  check(KSPSetType(ksp_, KSPPREONLY));
  check(KSPGetPC(ksp_, &pc));
  check(PCSetType(pc, PCCHOLESKY));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

void Solver::set_multigrid(bool hypre) {
  check(KSPSetType(ksp_, KSPCG));
  check(KSPCGSetType(ksp_, KSP_CG_SYMMETRIC));
  check(KSPSetNormType(ksp_, KSP_NORM_UNPRECONDITIONED));
  PC pc = nullptr;
  check(KSPGetPC(ksp_, &pc));
  check(PCSetType(pc, hypre ? PCHYPRE : PCGAMG));
  if (hypre) {
    set_default("-pc_hypre_type", "boomeramg");
    set_default("-pc_hypre_boomeramg_nodal_coarsen", "4");
    set_default("-pc_hypre_boomeramg_vec_interp_variant", "2");
    set_default("-pc_hypre_boomeramg_coarsen_type", "HMIS");
    set_default("-pc_hypre_boomeramg_interp_type", "ext+i");
    set_default("-pc_hypre_boomeramg_strong_threshold", "0.5");
    set_default("-pc_hypre_boomeramg_P_max", "4");
  } else {
    set_default("-pc_gamg_reuse_interpolation", "true");
    set_default("-pc_gamg_threshold", "0.02");
    set_default("-mg_levels_ksp_type", "chebyshev");
    set_default("-mg_levels_ksp_max_it", "2");
    // SOR would fail on coarse levels, where an aggregate of few vertices has less than six modes.
    set_default("-mg_levels_pc_type", "jacobi");
  }
  check(KSPSetTolerances(ksp_, 1e-2, 0, 1e10, 500));
  check(KSPSetFromOptions(ksp_));
  if (equations_.is_linear()) {
    check(KSPSetTolerances(ksp_, options_.tolerance / 10, 0, 1e10, 2000));
  } else {  // Eisenstat and Walker, SIAM J. Sci. Comput. 17, 1996, choice 2
    check(SNESKSPSetParametersEW(snes_, 2, 1e-2, 5e-2, 0.9, 1.5, 1.5, 0.1));
  }
}

PetscErrorCode Solver::function(SNES, Vec u, Vec forces, void* self) {
  return guarded([&] {
    auto* solver = static_cast<Solver*>(self);
    solver->state_ = solver->evaluate(u, forces);
  });
}

State Solver::evaluate(Vec u, Vec forces) {
  const auto start = Clock::now();
  const State state = equations_.at(u, fraction_, forces);
  check(VecScale(forces, -1));  // SNES wants the gradient
  result_.seconds.forces += since(start);
  return state;
}

PetscErrorCode Solver::jacobian(SNES, Vec u, Mat, Mat, void* self) {
  return guarded([&] { static_cast<Solver*>(self)->assemble(u); });
}

void Solver::assemble(Vec u) {
  count_linear();
  auto start = Clock::now();
  equations_.tangent(u, matrix_);
  result_.seconds.assembly += since(start);
  start = Clock::now();
  check(KSPSetOperators(ksp_, matrix_, matrix_));
  check(KSPSetUp(ksp_));
  if (direct_) grow_workspace();
  result_.seconds.setup += since(start);
}

// MUMPS estimates the memory of a factorisation before it decides, while it runs, which rank does what. The
// estimate may fall short by chance, above all on a busy machine. Then the matrix is factored from scratch
// with more, as all later ones are.
void Solver::grow_workspace() {
  for (int percent = 50; percent <= 1600 && lacks_workspace(); percent *= 2) {
    PC pc = nullptr;
    check(KSPGetPC(ksp_, &pc));
    check(PCReset(pc));
    check(PetscOptionsSetValue(nullptr, "-mat_mumps_icntl_14", std::to_string(percent).c_str()));
    check(KSPSetOperators(ksp_, matrix_, matrix_));
    check(KSPSetUp(ksp_));
  }
}

bool Solver::lacks_workspace() const {
  PC pc = nullptr;
  PCFailedReason reason = PC_NOERROR;
  check(KSPGetPC(ksp_, &pc));
  check(PCGetFailedReason(pc, &reason));
  return reason == PC_FACTOR_OUTMEMORY;
}

// Counts the iterations of the linear systems since the last call.
void Solver::count_linear() {
  if (direct_) return;
  PetscInt all = 0;
  check(KSPGetTotalIterations(ksp_, &all));
  result_.most_linear_iterations =
      std::max(result_.most_linear_iterations, int(all) - result_.linear_iterations);
  result_.linear_iterations = int(all);
}

PetscErrorCode Solver::converged(SNES, PetscInt iteration, PetscReal, PetscReal, PetscReal,
                                 SNESConvergedReason* reason, void* self) {
  return guarded([&] {
    const auto* solver = static_cast<Solver*>(self);
    const State& state = solver->state_;
    if (solver->options_.tell && solver->ranks_.rank() == 0)
      solver->options_.tell("load " + rounded(solver->fraction_) + ", Newton " + std::to_string(iteration) +
                            ": residual " + rounded(state.residual / std::max(state.scale, 1e-300)) + ", " +
                            std::to_string(solver->result_.linear_iterations) + " linear iterations so far");
    *reason = SNES_CONVERGED_ITERATING;
    if (!std::isfinite(state.scale))
      *reason = SNES_DIVERGED_FNORM_NAN;
    else if (state.residual <= solver->options_.tolerance * state.scale)
      *reason = SNES_CONVERGED_FNORM_RELATIVE;
    else if (iteration >= solver->options_.most_iterations)
      *reason = SNES_DIVERGED_MAX_IT;
  });
}

// Halves the step until it inverts no tetrahedron and lowers the potential, or lowers the residual where
// rounding hides the potential. Sets state_ to that of the trial. Coarse levels of multigrid do not know
// single prescribed components, so an iterative solution leaves these at zero only to its tolerance. They are
// set to zero, or the body would creep away from where it is held.
const char* Solver::search(Vec u, Vec direction, Vec forces, Vec trial, Vec trial_forces, double& length) {
  const State before = state_;
  PetscScalar slope = 0;
  equations_.clear_prescribed(direction);
  check(VecDot(forces, direction, &slope));  // gradient · (−step): SNES subtracts its direction
  const double least_ratio = std::min(0.0, before.smallest_volume_ratio);
  const char* trouble = "";
  for (length = 1; length > 1e-3; length /= 2) {
    check(VecWAXPY(trial, -length, direction, u));
    trouble = "every step inverts it";
    if (!equations_.is_linear() && !(equations_.smallest_volume_ratio(trial) > least_ratio)) continue;
    state_ = evaluate(trial, trial_forces);
    trouble = "no step lowers the potential";
    const bool falls = state_.potential <= before.potential - 1e-4 * length * slope;
    if (falls || state_.residual < 0.9 * before.residual) return nullptr;
  }
  state_ = before;
  return trouble;
}

PetscErrorCode Solver::line_search(SNESLineSearch search, void* self) {
  return guarded([&] {
    auto* solver = static_cast<Solver*>(self);
    Vec u = nullptr, forces = nullptr, direction = nullptr, trial = nullptr, trial_forces = nullptr;
    check(SNESLineSearchGetVecs(search, &u, &forces, &direction, &trial, &trial_forces));
    double length = 1;
    if (const char* trouble = solver->search(u, direction, forces, trial, trial_forces, length)) {
      solver->trouble_ = trouble;
      check(SNESLineSearchSetReason(search, SNES_LINESEARCH_FAILED_REDUCT));
      return;
    }
    check(VecCopy(trial, u));
    check(VecCopy(trial_forces, forces));
    check(SNESLineSearchSetLambda(search, length));
    check(SNESLineSearchComputeNorms(search));
    check(SNESLineSearchSetReason(search, SNES_LINESEARCH_SUCCEEDED));
  });
}

// Moves the boundary to the prescribed displacements of the load fraction. The body first follows linearly.
bool Solver::follow_boundary() {
  equations_.boundary_move(u_, fraction_, move_);
  PetscReal size = 0;
  check(VecNorm(move_, NORM_INFINITY, &size));
  return size == 0 || move_by_linear(move_);
}

bool Solver::move_by_linear(Vec move) {
  trouble_ = "the tangent is singular there (a mechanism, or a collapsed tetrahedron)";
  equations_.at(u_, fraction_, forces_);
  equations_.subtract_product(u_, move, forces_);
  assemble(u_);
  check(VecSet(direction_, 0));
  PetscReal tolerance = 0, absolute = 0, divergence = 0;
  PetscInt most = 0;
  check(KSPGetTolerances(ksp_, &tolerance, &absolute, &divergence, &most));
  check(SNESKSPSetUseEW(snes_, PETSC_FALSE));
  check(KSPSetTolerances(ksp_, equations_.is_linear() ? tolerance : 1e-4, absolute, divergence, most));
  check(KSPSolve(ksp_, forces_, direction_));
  check(KSPSetTolerances(ksp_, tolerance, absolute, divergence, most));
  KSPConvergedReason reason;
  check(KSPGetConvergedReason(ksp_, &reason));
  if (lacks_workspace()) trouble_ = no_memory;
  if (reason < 0) return false;
  equations_.clear_prescribed(direction_);
  check(VecAXPY(u_, 1, move));
  check(VecAXPY(u_, 1, direction_));
  ++result_.newton_iterations;
  trouble_ = "the prescribed displacements invert it";
  return equations_.is_linear() || equations_.smallest_volume_ratio(u_) > 0;
}

const char* Solver::trouble_of(SNESConvergedReason reason) const {
  if (reason == SNES_DIVERGED_LINE_SEARCH) return trouble_;
  if (reason == SNES_DIVERGED_MAX_IT) return "Newton's method did not converge";
  if (lacks_workspace()) return no_memory;
  if (reason == SNES_DIVERGED_FNORM_NAN) return "its forces are too large for double precision";
  return "the linear solver did not converge (the tangent is not positive definite there, or very badly "
         "conditioned)";
}

// Goes on from u_, the equilibrium at another fraction. u_ changes only on success.
bool Solver::find(double fraction) {
  fraction_ = fraction;
  check(VecCopy(u_, kept_));
  bool found = follow_boundary();
  if (found) {
    const bool inexact = !direct_ && !equations_.is_linear();
    check(SNESKSPSetUseEW(snes_, inexact ? PETSC_TRUE : PETSC_FALSE));
    check(SNESSolve(snes_, nullptr, u_));
    SNESConvergedReason reason;
    PetscInt iterations = 0;
    check(SNESGetConvergedReason(snes_, &reason));
    check(SNESGetIterationNumber(snes_, &iterations));
    result_.newton_iterations += iterations;
    found = reason > 0;
    if (!found) trouble_ = trouble_of(reason);
  }
  if (!found) {
    check(VecCopy(kept_, u_));
    return false;
  }
  result_.residual = state_.scale > 0 ? state_.residual / state_.scale : 0;
  result_.energy = state_.elastic;
  result_.smallest_volume_ratio = state_.smallest_volume_ratio;
  return true;
}

Solution Solver::run() {
  const auto start = Clock::now();
  double step = 1;
  while (result_.load_fraction < 1 && step >= options_.smallest_load_step) {
    const double fraction = std::min(1.0, result_.load_fraction + step);
    if (find(fraction)) {
      result_.load_fraction = fraction;
      ++result_.load_steps;
      step *= 2;
    } else {
      step = std::min(step, 1 - result_.load_fraction) / 2;
    }
  }
  result_.converged = result_.load_fraction == 1;
  if (!result_.converged)
    result_.reason = "no equilibrium beyond " + rounded(100 * result_.load_fraction) + " % of the load; " +
                     trouble_ + ": a volume_penalty, smaller loads or a finer mesh may help";
  count_linear();
  result_.u = equations_.local(u_);
  Seconds& s = result_.seconds;
  s.solve = since(start) - s.assembly - s.setup - s.forces;
  for (double* seconds : {&s.assembly, &s.setup, &s.solve, &s.forces}) *seconds = ranks_.max(*seconds);
  return std::move(result_);
}

}  // namespace

std::vector<std::string> available_methods() {
  check(MatInitializePackage());
  std::vector<std::string> methods{"auto", "gamg"};
#ifdef PETSC_HAVE_HYPRE
  methods.push_back("hypre");
#endif
  PetscBool found = PETSC_FALSE;
  check(MatSolverTypeGet(MATSOLVERMUMPS, MATMPIAIJ, MAT_FACTOR_CHOLESKY, nullptr, &found, nullptr));
  if (found) methods.push_back("mumps");
  return methods;
}

Method method_of(const std::string& name, const std::vector<std::string>& available) {
  std::string list;
  for (const std::string& method : available) list += (list.empty() ? "" : ", ") + method;
  const auto known = std::find(std::begin(method_names), std::end(method_names), name);
  if (known == std::end(method_names))
    throw InputError("--method", "\"" + name + "\", must be one of " + list);
  if (std::find(available.begin(), available.end(), name) == available.end())
    throw InputError("--method", "this PETSc was built without " + name + "; it has " + list);
  return Method(known - std::begin(method_names));
}

Solution solve_static(const Ranks& ranks, const Part& part, const Setup& setup,
                      const SolverOptions& options) {
  return Solver(ranks, part, setup, options).run();
}

}  // namespace lobe::petsc
