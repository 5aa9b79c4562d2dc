// The report of a frame. A frame never throws. The report says what happened, with named conditions.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "lobe/forces/event.h"
#include "lobe/types.h"

namespace lobe {

struct Condition {
  enum class Kind : std::uint8_t {
    diverged,     // the state was restored, and the world stands still. Remedy: smaller load, more damping,
                  // a volume penalty
    too_stiff,    // a frame needs too many steps. Remedy: softer material, coarser mesh, static solution
    sub_stepped,  // a frame was run again with smaller steps. Nothing to do
    near_inversion,  // a tetrahedron is below 5 % of its volume. Remedy: a volume penalty, a finer mesh there
    pieces,          // a cut set pieces loose. They do what the scene's loose_pieces says
    everything_cut,  // no tetrahedron is left
    unravelling,     // a tangle is linear until it has come back, or is non-linear again. See the text
    lumped,   // selective masses are lumped while tetrahedra are crushed, or are selective again. Steps
              // are shorter meanwhile. Nothing to do
    scalpel,  // a blade could not cut all that it met, is shorter than the tetrahedra there, or went far in
              // a frame. See the text
    lost_force,  // a force term acts where it has no effect. See the text
    clip         // a clip has closed on nothing. See the text
  };
  Kind kind;
  std::string text;  // one line for people: place, figures, remedy
  double time = 0;   // [s]
  static constexpr auto fields = std::tuple(&Condition::kind, &Condition::time, &Condition::text);
};
const char* name(Condition::Kind kind);

enum class Phase { forces, integration, time_step, cutting };
inline constexpr int phase_count = 4;
inline constexpr const char* phase_names[phase_count] = {"forces", "integration", "time_step", "cutting"};

// How often vertices of reduced regions were embedded or became full, and the energy that this added:
// velocities that a lattice cannot follow are lost, and full tetrahedra count in place of cells (theory,
// section 18).
struct Transitions {
  int count = 0;
  double kinetic = 0, elastic = 0, loads = 0;  // [J]
  double total() const { return kinetic + elastic + loads; }
  bool is_valid() const { return count >= 0 && std::isfinite(total()); }
  static constexpr auto fields =
      std::tuple(&Transitions::count, &Transitions::kinetic, &Transitions::elastic, &Transitions::loads);
};

struct Unreported {  // findings of edits since the last report
  std::vector<Condition> conditions;
  std::vector<Event> events;
  Transitions transitions;
  bool in_transition = false;  // whether energies are compared around a transition
};

struct Report {
  bool ok = true;  // false: the world could not be advanced
  int steps = 0;
  double time_step = 0;  // smallest step that was taken [s]
  // The longest stable step, at the frame's start or up to StepLimit::interval earlier [s].
  // smallest_volume_ratio is found with it.
  double time_step_limit = 0;
  Index limiting_vertex = -1;  // the vertex that sets the limit; one of them if there are several
  int reruns = 0;              // repeats of the frame, with smaller steps
  Index tets_removed = 0;
  Index tets_copied = 0;  // tetrahedra that blades have copied
  double cut_area = 0;    // area that blades have opened, at rest [m²]
  double mass_added = 0;  // mass added since the start where blades have cut, to keep the time step [kg]
  long long patches_evaluated = 0, patches_skipped = 0;  // sums over all evaluations; skipped: asleep
  double smallest_volume_ratio = 1;           // the least det F of non-linear tetrahedra and lattice cells
  Transitions transitions;                    // transitions of reduced regions since the last report
  std::array<double, phase_count> seconds{};  // wall time of each phase
  std::vector<Condition> conditions;
  std::vector<Event> events;  // what tore, broke, burnt, was clipped or pierced, bleeds and leaks
};
}  // namespace lobe
