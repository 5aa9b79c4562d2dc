// World simulates a body: it advances time, plays tools, cuts, and reports what happened.
//
// Time integration is explicit: central differences in velocity form ([PDA] section 3.2 with erratum 3). An
// implicit scheme is there as a reference and for stiff scenes. Regions of different models share vertices. A
// step costs O(#tetrahedra), plus O(n²) for the n interface vertices of a pre-computed region. Most edits
// cost O(their size); apply() names the exceptions.
//
// Real is float, or double for references. One thread calls a world; other threads read its snapshots().
// lobe/lobe.h explains the words: condensed, tangle, grain …
//
//   World<float> world(setup);
//   for (int frame = 0; frame < 60; ++frame) world.advance(1.0 / 30);
#pragma once

#include "lobe/organ/organ.h"
#include "lobe/sim/command.h"

namespace lobe {

template <class Real>
struct Checkpoint;
template <class Real>
class World;
template <class Real>
void incise(World<Real>& world, const std::vector<Incision>& incisions);
struct RebuildDifference;
template <class Real>
RebuildDifference compare_with_rebuilt(World<Real>& world);

template <class Real>
class World {
 public:
  // Throws InputError if the setup is inconsistent, asks for a region model that is not available, or for the
  // implicit integrator in single precision.
  // `progress` is called with the finished share of what takes long: condensing pre-computed regions.
  explicit World(const Setup& setup, int threads = 1, const Progress& progress = {});

  // ---- Time

  // Advances by one frame: plays tools and cuts, then takes as many steps as stability needs.
  // - Tools cut at the start of a frame what they will sweep during it. Grasps take hold and let go on time.
  // - If a step fails, the frame is run again with smaller steps, in at most nine tries. If all fail, the
  //   displacements and velocities at its start are restored (cuts stay), and the report says why. No NaN is
  //   left behind.
  // - Throws InputError for a duration that is not positive and finite, and nothing else.
  Report advance(double duration);  // [s], > 0
  // One step of dt [s] without tools, cuts and checks. False if an implicit step was not solved; then nothing
  // has moved.
  bool step(double dt);

  // ---- Edits

  // Performs a command. Stiffness, mass, loads and boundary are updated only around what changed. Two things
  // may cost more: a pre-computed region that must be condensed from scratch (theory, section 14), and the
  // search for loose pieces, which is O(#tets) where a local search does not decide. Throws InputError for
  // what cannot be done, and then has changed nothing.
  void apply(const Command& command);
  // Adds a force on the body (forces/force_term.h). Explicit integrator only. Its name()
  // must differ from those of all other terms.
  void add(std::shared_ptr<ForceTerm<Real>> term) { organ_.add(std::move(term)); }
  // Removes tetrahedra that are still there; returns how many went. Setup::loose_pieces says what becomes of
  // pieces that come loose.
  Index remove_tets(const std::vector<Index>& tets) { return organ_.remove_tets(tets); }

  // ---- State

  double time() const { return organ_.time(); }
  // Displacements [m] and velocities [m/s], 3 × #vertices. They are valid until the next change of the world.
  // The interior of a pre-computed region is in equilibrium with its interface. It is computed by this call,
  // not by each step. set_state() ignores the values for that interior.
  StateView<Real> state() { return organ_.state(); }
  // Displacements, 3 × #vertices [m]: half of the work of state().
  Eigen::Map<const Mat3X<Real>> displacements() { return organ_.displacements(); }
  void set_state(const State<Real>& state) { organ_.set_state(state); }
  const Elements& elements() const { return organ_.elements(); }
  // Whether a tangle is being unravelled: its crushed tetrahedra are linear until they have come back.
  bool is_unravelling() const { return organ_.unravelling().is_on(); }
  const Tools& tools() const { return tools_; }
  const Grains* grains() const { return organ_.grains(); }  // null: no blade has cut
  const HeldVertices& held() const { return organ_.held(); }
  // The body of the world, for benchmarks and watches. Do not change it through this reference.
  Dynamics<Real>& body() { return organ_.body(); }
  const Dynamics<Real>& body() const { return organ_.body(); }

  // ---- Surface and snapshots (docs/threads.md)

  // The boundary of the body. The first call makes it; from then on each cut updates it, in O(edit).
  const Surface& surface() { return organ_.display().surface(elements(), grains()); }
  // The observer is called after each edit of the mesh, so that a Skin can follow. restore() does not call
  // it.
  void on_cut(CutObserver observer) { organ_.display().on_cut(std::move(observer)); }
  // Publishes a snapshot of the present state, with the report of the last frame. Other threads then get it
  // by snapshots(). Costs a copy of the state and the normals of the surface. If readers hold all slots, no
  // snapshot is made.
  void publish(const Report& report);
  const TripleBuffer<Snapshot<Real>>& snapshots() const {  // for any thread
    return organ_.display().snapshots();
  }

  // ---- Stable step, forces, energies

  // The longest stable step 2/ω_max at the current state [s]; infinite if nothing is free. After cuts only
  // their neighbourhood is computed again, if nothing has moved since the last call and there is no nodal
  // pressure.
  double time_step_limit() {
    organ_.refresh_terms();
    return organ_.limit().find(body());
  }
  StepLimit<Real>& step_limit() { return organ_.limit(); }  // search of the limit
  Eigen::Map<const Mat3X<Real>> forces();  // 3 × #vertices, internal and external, at the current state [N]
  Energies energies() {
    organ_.refresh_terms();
    aim_hold_springs();
    return body().energies();
  }

  // ---- Checkpoints and journal

  // save() returns all that has changed since the world was built (checkpoint.h). restore() goes back to it.
  // restore() costs a copy if nothing was edited since, otherwise as much as building a world. It throws
  // InputError for a checkpoint of another setup and for one that is not finite; the world is then unchanged.
  Checkpoint<Real> save() const;
  void restore(const Checkpoint<Real>& checkpoint);
  const Journal& journal() const { return organ_.journal(); }  // its setup, and its edits since
  // Returns the cut body at rest as a setup, without displacements, velocities and time. `compacted` says
  // where the vertices and tetrahedra of that setup come from.
  Setup current_setup(CompactMesh& compacted) const { return organ_.current_setup(compacted); }

 private:
  friend void incise<Real>(World& world, const std::vector<Incision>& incisions);
  friend RebuildDifference compare_with_rebuilt<Real>(World& world);

  void begin_frame(double duration);
  void prepare_frame(double duration, Report& report);
  void play_tools(double duration, Report& report);
  void sew();  // draws threads through the bites that needles have made
  void cut(const BladeMove& move, Report& report);
  void advance_to(double end, Report& report);
  bool take_step(double dt, Report& report);
  bool run_steps(int steps, double dt, bool first_try, Report& report);
  void move(double dt);
  void move_driven(double dt);
  void aim_hold_springs();
  Vec3d prescribed_displacement(const HeldVertices::Held& item, double time) const;
  bool implicit_step(double dt);

  void take(const Checkpoint<Real>& checkpoint);
  void load_terms(const Checkpoint<Real>& checkpoint);

  Organ<Real> organ_;
  Tools tools_;
};

// Makes incisions that a blade has made in an equal body (Incised::incision). Tetrahedra are divided once,
// after the last one. Throws InputError for what does not fit the grains. For references and tests: blades
// decide by themselves.
template <class Real>
void incise(World<Real>& world, const std::vector<Incision>& incisions);

// Positions, directions and forces of all tools of a world.
template <class Real>
std::vector<PlacedTool> placed_tools(World<Real>& world);

// Threads that are sewn, in the order of their numbers, with a line for each part and each loop.
template <class Real>
std::vector<ThreadLine> thread_lines(World<Real>& world);
// What all force terms draw: threads, and the strands of attachments.
template <class Real>
std::vector<TermLines> term_lines(World<Real>& world);
// The attachments of a world, also those of which nothing is left; none: it has none.
template <class Real>
std::vector<AttachmentFigures> attachment_figures(World<Real>& world);
// The needles that sew, as they were at the end of the last frame.
template <class Real>
std::vector<NeedleFigures> needle_figures(World<Real>& world);
// The clips that were closed, those that have fallen off included.
template <class Real>
std::vector<ClipFigures> clip_figures(World<Real>& world);
// The bodies that carry blood or bile, as they were when the last frame began its steps.
template <class Real>
std::vector<CarrierFigures> carrier_figures(World<Real>& world);

extern template class World<float>;
extern template class World<double>;

}  // namespace lobe
