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

#include <functional>
#include <map>

#include "lobe/sim/display.h"
#include "lobe/sim/history.h"
#include "lobe/sim/pieces.h"
#include "lobe/sim/scalpels.h"
#include "lobe/sim/touch_expansion.h"
#include "lobe/time/implicit_dynamics.h"
#include "lobe/time/step_limit.h"
#include "lobe/time/unravelling.h"

namespace lobe {

template <class Real>
struct Checkpoint;
template <class Real>
class World;
template <class Real>
void incise(World<Real>& world, const std::vector<Incision>& incisions);

template <class Real>
class World {
 public:
  // Throws InputError if the setup is inconsistent, asks for a region model that is not available, or for the
  // implicit integrator in single precision.
  // `condensing` is called with the finished share while pre-computed regions are condensed.
  explicit World(const Setup& setup, int threads = 1, const CondensingLog::Progress& condensing = {});

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
  void add(std::shared_ptr<ForceTerm<Real>> term);
  // Removes tetrahedra that are still there; returns how many went. Setup::loose_pieces says what becomes of
  // pieces that come loose.
  Index remove_tets(const std::vector<Index>& tets);

  // ---- State

  double time() const { return body_.motion.time; }
  // Displacements [m] and velocities [m/s], 3 × #vertices. They are valid until the next change of the world.
  // The interior of a pre-computed region is in equilibrium with its interface. It is computed by this call,
  // not by each step. set_state() ignores the values for that interior.
  StateView<Real> state();
  Eigen::Map<const Mat3X<Real>> displacements();  // 3 × #vertices [m]: half of the work of state()
  void set_state(const State<Real>& state);
  const Elements& elements() const { return body_.model.elements; }
  // Whether a tangle is being unravelled: its crushed tetrahedra are linear until they have come back.
  bool is_unravelling() const { return unravelling_.is_on(); }
  const Tools& tools() const { return tools_; }
  const Grains* grains() const { return scalpels_.grains(); }  // null: no blade has cut
  const HeldVertices& held() const { return body_.model.held; }
  // The body of the world, for benchmarks and watches. Do not change it through this reference.
  Dynamics<Real>& body() { return body_; }
  const Dynamics<Real>& body() const { return body_; }

  // ---- Surface and snapshots (docs/threads.md)

  // The boundary of the body. The first call makes it; from then on each cut updates it, in O(edit).
  const Surface& surface() { return display_.surface(elements(), grains()); }
  // The observer is called after each edit of the mesh, so that a Skin can follow. restore() does not call
  // it.
  void on_cut(CutObserver observer) { display_.on_cut(std::move(observer)); }
  // Publishes a snapshot of the present state, with the report of the last frame. Other threads then get it
  // by snapshots(). Costs a copy of the state and the normals of the surface. If readers hold all slots, no
  // snapshot is made.
  void publish(const Report& report);
  const TripleBuffer<Snapshot<Real>>& snapshots() const { return display_.snapshots(); }  // from any thread

  // ---- Stable step, forces, energies

  // The longest stable step 2/ω_max at the current state [s]; infinite if nothing is free. After cuts only
  // their neighbourhood is computed again, if nothing has moved since the last call and there is no nodal
  // pressure.
  double time_step_limit() {
    refresh_terms();
    return limit_.find(body_);
  }
  StepLimit<Real>& step_limit() { return limit_; }  // how it is found
  Eigen::Map<const Mat3X<Real>> forces();  // 3 × #vertices, internal and external, at the current state [N]
  Energies energies() {
    refresh_terms();
    return body_.energies();
  }

  // ---- Checkpoints and journal

  // save() returns all that has changed since the world was built (checkpoint.h). restore() goes back to it.
  // restore() costs a copy if nothing was edited since, otherwise as much as building a world. It throws
  // InputError for a checkpoint of another setup and for one that is not finite; the world is then unchanged.
  Checkpoint<Real> save() const;
  void restore(const Checkpoint<Real>& checkpoint);
  const Journal& journal() const { return journal_; }  // what it was built from, and its edits since
  // Returns the cut body at rest as a setup, without displacements, velocities and time. Mass scaling is
  // computed anew. `compacted` says where the vertices and tetrahedra of that setup come from.
  Setup current_setup(CompactMesh& compacted) const;

 private:
  void perform(const Advance& command) { advance(command.duration); }
  void perform(const RemoveTets& command) { remove_tets(command.tets); }
  void perform(const SetRegion& command);
  void perform(const Expand&);
  void perform(const Condense&);
  void perform(const Relinearise& command);
  void perform(const SetMassDegree& command);
  void perform(const KeepFull& command);
  void perform(const SetForces& command);
  void perform(const SetSprings& command);
  void perform(const MoveSprings& command);
  template <class Bring>
  requires requires { &Bring::check; }
  void perform(const Bring& command) {
    command.check(elements().topology.vertex_count(), options_of(setup_));
    tools_.bring(command);
    if constexpr (Bring::needs_grains) prepare_blades();
  }
  void perform(const Lead& command) { tools_.lead(command.tool, command.target); }
  void perform(const SwitchTool& command) { tools_.turn_on(command.tool, command.on); }
  void perform(const LetGo& command) { tools_.let_go(command.tool); }

  // Repeats an entry of a journal without its consequences, which are entries as well. Throws InputError for
  // one that does not fit, as a damaged file may have it.
  void repeat(const RemoveTets& entry);
  void repeat(const SetRegion& entry);
  void repeat(const Expand& entry) { perform(entry); }
  void repeat(const Condense& entry) { perform(entry); }
  void repeat(const Incise& entry) { make_again(entry.incisions); }
  void repeat(const Hold& entry) { hold(entry.held); }
  void repeat(const BeginCondensing& entry) { begin_condensing(entry); }
  void repeat(const EndCondensing&) { end_condensing(); }
  void repeat(const Superseded& entry) { journal_.edits.push_back(entry); }

  friend void incise<Real>(World& world, const std::vector<Incision>& incisions);
  void hold(const HeldVertices& held);
  void begin_condensing(BeginCondensing begin);
  void end_condensing();
  MeshEdit make_again(const std::vector<Incision>& incisions);
  void prepare_blades();
  void start_blades();
  bool has_floor() const { return !implicit_ && setup_.cut_step > 0; }  // of masses, once a blade cuts
  typename Blades::BodyNow body_now();
  void incise(const BladeMove& move, Report& report);
  void make_way(const BladeMove& move);
  MeshEdit divide(const std::vector<Index>& opened);
  void begin_floor();
  void follow_with_surface(const MeshEdit& edit);
  MeshEdit cut(const std::vector<Index>& tets);
  void change_region(const std::vector<Index>& tets, RegionModel model);
  RegionEdit change_of_region(const std::vector<Index>& tets, RegionModel model);
  void follow(const MeshEdit& edit);
  void follow(RegionEdit edit);
  void add_unsupported(RegionEdit& edit);
  void update_masses(const std::vector<Index>& vertices);
  void update_vertices_apart(const std::vector<Index>& vertices);
  void update_vertices(const std::vector<Index>& vertices);
  void update_inverse_masses(const std::vector<Index>& vertices);
  void take_over(const std::vector<Index>& vertices);
  void find_carried();
  bool embed(const std::vector<Index>& also_pressed = {});
  bool slow_strained();
  void embed_as(VertexRoles roles);
  void as_transition(const std::function<void()>& change);
  void free_ahead(const std::vector<Index>& tets);
  void set_expanded(bool is_expanded);
  void use_mass_degree(int degree);
  void forget_former_condensing();
  void scale_masses(double share);
  Index treat_loose(const std::vector<std::vector<Index>>& pieces);
  void freeze(const std::vector<Index>& piece);
  void check_tets(const std::vector<Index>& tets) const;
  void notice(Condition::Kind kind, const std::string& text) {
    next_report_.conditions.push_back({kind, text, time()});
  }

  void begin_frame(double duration);
  void show_tools(double from, double until);
  void show_body();
  void prepare_frame(double duration, Report& report);
  void condense_anew();
  void unravel();
  void play_tools(double duration, Report& report);
  void advance_to(double end, Report& report);
  bool take_step(double dt, Report& report);
  bool run_steps(int steps, double dt, bool first_try, Report& report);
  bool is_in_trouble(double dt, bool first_try) const;
  void go_back(const StateColumns<Real>& state, const Sleep::State& sleep);
  std::string culprit() const;
  void move(double dt);
  void end_step(double dt);
  void move_driven(double dt);
  void add_tool_forces(double dt);
  Vec3d prescribed_displacement(const HeldVertices::Held& item, double time) const;
  bool implicit_step(double dt);
  void synchronise_velocities();
  void see_interior();
  std::vector<Index> meeting(const SweptVolume& volume);

  static void check(const State<Real>& state);
  Setup initial_setup() const;
  void check_fits(const Checkpoint<Real>& checkpoint) const;
  Index settle(const MeshEdit& edit);
  void take(const Checkpoint<Real>& checkpoint);
  void take_nodes(const Checkpoint<Real>& checkpoint);
  void load_terms(const Checkpoint<Real>& checkpoint);

  struct Shown {
    std::uint64_t structure = 0, inertia = 0;
    int mass_degree = 0;
    bool operator==(const Shown&) const = default;
  };
  Shown now_shown() const {
    const Revisions& now = body_.model.revisions;
    return {now.structure, now.inertia, body_.inertia.degree_now()};
  }
  ForceTerm<Real>& own_term(std::string_view name);
  AppliedForces<Real>& applied();
  void show_body_to(ForceTerm<Real>& term);
  void refresh_terms();
  double softening();
  bool follow_touch(const std::vector<Index>& touched);
  void terms_have_changed(const std::vector<Index>& woken_before);
  void report_lost_forces(const std::vector<Index>& vertices);

  Setup setup_;  // loads, gravity, damping …; without the mesh and its materials
  Journal journal_;
  Dynamics<Real> body_;
  StepLimit<Real> limit_;
  Unravelling unravelling_;
  Pieces pieces_;
  Tools tools_;
  Scalpels scalpels_;
  Revisions seen_{.structure = ~std::uint64_t(0)};  // when a condensed interior was looked at last
  std::unique_ptr<ImplicitDynamics> implicit_;      // none: central differences
  TouchExpansion touch_expansion_;
  NextReport next_report_;
  Display<Real> display_;
  Shown shown_;                      // of the body, when force terms saw it last
  std::map<int, double> softening_;  // of contact, per degree of selective masses; those that were found
};

// Makes incisions that a blade has made in an equal body (Incised::incision). Tetrahedra are divided once,
// after the last one. Throws InputError for what does not fit the grains. For references and tests: blades
// decide by themselves.
template <class Real>
void incise(World<Real>& world, const std::vector<Incision>& incisions);

// Positions, directions and forces of all tools of a world.
template <class Real>
std::vector<PlacedTool> placed_tools(World<Real>& world);

extern template class World<float>;
extern template class World<double>;

}  // namespace lobe
