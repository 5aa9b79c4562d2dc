// A body in motion: its rest data, its state, its forces and its inertia. World plays frames, tools and cuts
// on it.
#pragma once

#include <optional>

#include "lobe/body/hold_springs.h"
#include "lobe/forces/force_term.h"
#include "lobe/time/inertia.h"
#include "lobe/time/own_steps.h"
#include "lobe/time/sleep.h"

namespace lobe {

struct Energies {  // [J]
  double kinetic = 0, elastic_linear = 0, elastic_nonlinear = 0;
  double loads = 0;    // −(gravity and dead loads) · u
  double applied = 0;  // energy of force terms, and of the springs of partly held vertices
  double elastic() const { return elastic_linear + elastic_nonlinear; }
  double total() const { return kinetic + elastic() + loads + applied; }
};

template <class Real>
struct Dynamics {
  Dynamics(const Setup& setup, int threads, const Progress& progress);

  Model model;
  Motion<Real> motion;
  Regions<Real> regions;
  Loads<Real> loads;
  HoldSprings<Real> hold_springs;
  ForceTerms<Real> terms;
  Inertia<Real> inertia;
  Sleep sleep;
  std::optional<OwnSteps<Real>> own_steps;  // none: all step together
  Parallel parallel;
  double damping = 0;  // γ [1/s]

  // Computes all forces at the state into motion.forces [N], held vertices included.
  // `kick` says what the step that follows makes of them; none: no step follows.
  void find_forces(const Kick& kick = {}) {
    find_forces(kick, {motion.velocity_lag, kick.dt / 2, kick.dt > 0});
  }
  // The kick of a step of dt [s] from the present state.
  Kick kick_of(double dt) const {
    const StepFactors<double> step(motion.velocity_lag + dt / 2, dt, damping);
    return {step.keep, step.push, step.dt};
  }
  // Computes the displacements of what follows others, and its velocities if asked for.
  void recover(typename Regions<Real>::Interior wanted);
  void recover_followers();  // with velocities, if there are any
  void find_moving();        // finds the vertices that move
  void prepare_inertia();    // prepares the couplings of selective masses, too
  Energies energies();
  Energies energies_without_terms();  // all but the energy of force terms
  Vec3d reaction(int holder);         // force that the holder must apply now [N]

  // Sets where the springs of partly held vertices draw them now: prescribed(item), a displacement [m].
  template <class Prescribed>
  void aim_hold_springs(Prescribed&& prescribed) {
    hold_springs.follow(model);
    hold_springs.aim(motion.time, prescribed);
  }

  // Advances velocities and displacements by dt [s] with the forces of the last evaluation, which it
  // overwrites. Forces act for the time `kick`: half of the last step and half of this one.
  void push(double kick, double dt);
  void end_step();  // ends a step of central differences, once motion.speeds are known
  // Restores the held components of vertices that slide: free in some components, held in others.
  void restore_held_components();
  // Brings velocities up to the time of the displacements, before an edit makes the forces jump. The forces
  // from before the edit act until then, those after it from then on.
  void synchronise_velocities();

  typename ForceTerm<Real>::At here(const Kick& kick = {}) const {
    return {model, motion.u.padded(), motion.v.padded(), motion.time, kick};
  }
  bool any_own_steps() const { return own_steps && own_steps->any(); }
  // Vertices on which force terms act, and those that they wake.
  std::vector<Index> acted_on_by_terms() const;
  std::vector<Index> woken_by_terms() const;

  // Call it after the state was changed by other means than a step.
  void state_was_replaced();
  void state_has_moved();

 private:
  // `all`: of all levels, as at the start of a frame.
  void find_forces_of_own_steps(const Kick& kick, bool all);
  // The strains of dashpots are as old as velocities are.
  void find_forces(const Kick& kick, const ViscousStep& step);
};

extern template struct Dynamics<float>;
extern template struct Dynamics<double>;

}  // namespace lobe
