// Organ is a body that edits itself: it follows cuts, changes of region, grasps and forces around what
// changed, and brings masses, loads, regions, the step limit, the surface and the journal up to date. A World
// plays time and tools on it.
//
// An edit is a Change, which is made in one place (edit) and followed in one list (follow): first velocities
// are brought up to the displacements and what follows others is recovered, so that nothing is lost where
// vertices change what they follow. The wishes of kinds of regions are a list as well (wishes.cpp).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lobe/cut/tet_groups.h"
#include "lobe/forces/attachments.h"
#include "lobe/forces/clips.h"
#include "lobe/forces/needles.h"
#include "lobe/forces/threads.h"
#include "lobe/organ/change.h"
#include "lobe/organ/display.h"
#include "lobe/organ/history.h"
#include "lobe/organ/pieces.h"
#include "lobe/organ/touch_expansion.h"
#include "lobe/scalpel/blade_work.h"
#include "lobe/time/implicit_dynamics.h"
#include "lobe/time/step_limit.h"
#include "lobe/time/unravelling.h"

namespace lobe {

using WishMemory = TouchExpansion;  // what wishes know from frame to frame; part of a checkpoint

template <class Real>
class Organ {
 public:
  Organ(const Setup& setup, int threads, const Progress& progress);

  // ---- Edits. Each throws InputError for what cannot be done, and then changes nothing.

  void perform(const RemoveTets& edit) { remove_tets(edit.tets); }
  void perform(const SetRegion& edit);
  void perform(const Expand& edit);
  void perform(const Condense& edit);
  void perform(const Relinearise& edit);
  void perform(const SetMassDegree& edit);
  void perform(const KeepFull& edit);
  void perform(const SetForces& edit);
  void perform(const SetSprings& edit);
  void perform(const MoveSprings& edit);
  void perform(const BringThread& edit);
  void perform(const Bite& edit);
  void perform(const Pull& edit);
  void perform(const Tie& edit);
  void perform(const CutThread& edit);
  void perform(const Attach& edit);
  void perform(const Detach& edit);
  void add(std::shared_ptr<ForceTerm<Real>> term);
  Index remove_tets(const std::vector<Index>& tets);  // returns how many went, with what came loose
  // Sets which vertices are held. Returns how many tetrahedra vanished, because they came loose.
  Index grasp(const HeldVertices& held);
  // Repeats an entry of a journal without its consequences, which are entries as well. Throws InputError for
  // one that does not fit, as a damaged file may have it.
  void repeat(const JournalEntry& entry);

  // ---- Blades and cauteries

  // Makes ahead of the first cut, because it takes longer than a frame: the grains, the groups of tetrahedra
  // for its search, and what the mass floor needs.
  void prepare_blades();
  struct Cut {
    std::vector<BladeWork::Step> steps;
    double area = 0;                // area that was opened, at rest [m²]
    Index copied = 0, removed = 0;  // numbers of tetrahedra
  };
  Cut cut(const BladeMove& move);
  void incise(const std::vector<Incision>& incisions);  // as a blade has made them in an equal body
  Index burn(const SweptVolume& volume);  // removes the tetrahedra that meet it; returns how many went
  void close(const ClipClosure& clip);    // closes on what lies between the clip's legs
  // Call it before tools burn and cut: force terms lose what they have there and is no tissue.
  void sever(const SweptVolume& volume);
  void sever(const BladeMove& move);

  // ---- Before the steps of a frame

  // Grants what kinds of regions wish for at this moment. Returns whether anything has changed.
  bool grant(const Occasion& occasion);
  // Shows force terms the tools that exist in the frame; shows them the body.
  void show_tools(std::span<const ToolBody> bodies);
  // Shows the terms of needles and threads the needles that sew between two times [s]. Call sew() before, for
  // the bites that needles have made since take_bites() was called last: draws a thread through one, which is
  // made if there is none of this number.
  void show_needles(std::span<const NeedleBody> needles, double from, double to);
  std::vector<NeedleBite> take_bites();
  void sew(const NeedleBite& bite, const NeedleThread& thread);
  void show_body();
  // Call it before terms are asked for forces or stiffness: they see the body that edits have left since they
  // saw it, as those of a restored organ do, and vertices that follow others where these now are.
  void refresh_terms();
  void show_body_anew() {  // shows it whatever they have seen
    shown_ = {};
    refresh_terms();
  }
  void end_step(double dt);  // tells what follows the motion how far it went in a step of central differences
  // Says that one more step was made: no vertex moved further than `distance` [m] in it apart from rounding.
  void moved(double distance, double rounding) { groups_.moved(distance, rounding); }

  // Reports what the steps of a frame have evaluated and changed.
  void report_frame(const PatchCount& before, Report& report);

  // ---- State

  StateView<Real> state();
  Eigen::Map<const Mat3X<Real>> displacements();
  void set_state(const State<Real>& state);
  static void check(const State<Real>& state);  // throws InputError for a state that no body can be in
  // Gives vertices the roles of a checkpoint, and nodes its state.
  void take_nodes(const typename Regions<Real>::State& nodes, const State<Real>& state);
  // Takes from an organ of the same setup what no checkpoint has: force terms, what was found out about
  // contact, the surface and its observers.
  void take_surroundings(Organ& former);
  // The term of a kind that an organ makes by itself. It exists from the first call on. Forces of terms are
  // added in one order, whichever exist: those of these kinds first, in the order of the kinds.
  ForceTerm<Real>& own_term(std::string_view name);
  // Reports that a force on a vertex that follows others had no effect in a frame.
  void report_unseen_force(Index vertex);
  // Brings pre-computed regions into the mode of another organ, which is linearised about the same
  // displacements; `vertices`: the number in the other one of each vertex of this one.
  void take_mode(const Organ& other, const std::vector<Index>& vertices);
  void notice(Condition::Kind kind, const std::string& text) {
    unreported_.conditions.push_back({kind, text, time()});
  }

  double time() const { return body_.motion.time; }
  const Elements& elements() const { return body_.model.elements; }
  const Grains* grains() const { return blades_.grains(); }  // null: no blade has cut
  const HeldVertices& held() const { return body_.model.held; }
  const Setup& setup() const { return setup_; }  // all but the mesh and its materials
  const Journal& journal() const { return journal_; }
  Setup initial_setup() const;                        // the setup before all edits, without copies
  Setup current_setup(CompactMesh& compacted) const;  // World::current_setup()

  // ---- Its parts, on which a world takes steps, and which it shows and stores

  Dynamics<Real>& body() { return body_; }
  const Dynamics<Real>& body() const { return body_; }
  StepLimit<Real>& limit() { return limit_; }
  const StepLimit<Real>& limit() const { return limit_; }
  Unravelling& unravelling() { return unravelling_; }
  const Unravelling& unravelling() const { return unravelling_; }
  Pieces& pieces() { return pieces_; }
  const Pieces& pieces() const { return pieces_; }
  BladeWork& blades() { return blades_; }
  const BladeWork& blades() const { return blades_; }
  ImplicitDynamics* implicit() const { return implicit_.get(); }  // null: central differences
  WishMemory& wish_memory() { return wish_memory_; }
  const WishMemory& wish_memory() const { return wish_memory_; }
  Unreported& unreported() { return unreported_; }
  const Unreported& unreported() const { return unreported_; }
  Display<Real>& display() { return display_; }
  const Display<Real>& display() const { return display_; }

 private:
  // ---- An edit, and what follows it

  Change edit(const Before& before, const std::function<Change()>& make);
  void edit_terms(const Before& before, const std::function<void()>& make);
  void follow(Change& change);
  std::optional<RegionEdit> follow_mesh(const MeshEdit& edit);
  void follow_regions(RegionEdit& edit);
  void follow_frozen(const std::vector<Index>& vertices);
  void follow_condensing();
  void follow_mode(bool is_expanded);
  void follow_roles(VertexRoles roles);
  void follow_mass_degree(int degree);
  void follow_terms(const std::vector<Index>& woken_before);
  void follow_search();
  void add_unsupported(RegionEdit& edit);
  void update_masses(const std::vector<Index>& vertices);
  void update_vertices_apart(const std::vector<Index>& vertices);
  void update_vertices(const std::vector<Index>& vertices);
  void update_inverse_masses(const std::vector<Index>& vertices);
  void take_over(const std::vector<Index>& vertices);
  void find_carried();
  void as_transition(const std::function<void()>& change);
  void synchronise_velocities();

  void begin_own_steps();

  // ---- Edits

  MeshEdit cut(const std::vector<Index>& tets);
  void change_region(const std::vector<Index>& tets, RegionModel model);
  RegionEdit change_of_region(const std::vector<Index>& tets, RegionModel model);
  void hold(const HeldVertices& held);
  void begin_condensing(BeginCondensing begin);
  void end_condensing();
  void forget_former_condensing();
  void use_mass_degree(int degree);
  void give(VertexRoles roles, const Before& before);
  void repeat(const RemoveTets& entry);
  void repeat(const SetRegion& entry);
  void repeat(const Expand& entry) { perform(entry); }
  void repeat(const Condense& entry) { perform(entry); }
  void repeat(const Incise& entry) { make_again(entry.incisions); }
  void repeat(const Hold& entry) { hold(entry.held); }
  void repeat(const BeginCondensing& entry) { begin_condensing(entry); }
  void repeat(const EndCondensing&) { end_condensing(); }
  void repeat(const Superseded& entry) { journal_.edits.push_back(entry); }
  Index treat_loose(const std::vector<std::vector<Index>>& pieces);
  void freeze(const std::vector<Index>& piece);
  void check_tets(const std::vector<Index>& tets) const;
  // Computes where vertices that follow others are, before a tool searches them.
  void see_interior();
  std::vector<Index> meeting_as_seen(const SweptVolume& volume);  // tetrahedra that meet it, ascending

  // ---- Blades

  void start_blades();
  bool has_floor() const { return !implicit_ && setup_.cut_step > 0; }  // masses have a floor
  void begin_floor();
  typename Blades::BodyNow body_now();
  void make_way(const BladeMove& move);
  MeshEdit make_again(const std::vector<Incision>& incisions);
  MeshEdit divide(const std::vector<Index>& opened);
  Index settle(const MeshEdit& edit);
  void note_burnt(const std::vector<Index>& tets);

  // ---- Wishes: they return whether anything has changed

  bool condense_anew(const Occasion&);
  bool unravel(const Occasion&);
  bool follow_touch(const Occasion& tool);
  bool expand_ahead(const Occasion& blade);
  bool free_ahead(const Occasion& cut);
  bool embed(const Occasion& steps = {Moment::steps_begin});
  bool slow_strained(const Occasion&);

  // ---- Force terms

  struct Shown {
    std::uint64_t structure = 0, inertia = 0;
    int mass_degree = 0;
    bool operator==(const Shown&) const = default;
  };
  Shown now_shown() const {
    const Revisions& now = body_.model.revisions;
    return {now.structure, now.inertia, body_.inertia.degree_now()};
  }
  void show_body_to(ForceTerm<Real>& term);
  double softening();
  AppliedForces<Real>& applied();
  // Changes the term of a kind, which is made if there is none. If change() throws, nothing has changed.
  template <template <class> class Term>
  void change_term(const std::function<void(Term<Real>&)>& change) {
    const Term<Real>* present = term_of<Term>(body_.terms);
    Term<Real> trial = present ? *present : Term<Real>{Setup()};
    change(trial);
    edit_terms({.velocities = true, .followers = true},
               [&] { change(static_cast<Term<Real>&>(own_term(Term<Real>::term_name))); });
  }
  void check_bite(int thread, const EmbeddedPoint& point) const;
  void report_lost_forces(const std::vector<Index>& vertices);

  Setup setup_;  // loads, gravity, damping …; without the mesh and its materials
  Journal journal_;
  Dynamics<Real> body_;
  StepLimit<Real> limit_;
  Unravelling unravelling_;
  Pieces pieces_;
  BladeWork blades_;
  TetGroups groups_;                                // groups of tetrahedra, for searches
  std::uint64_t jumps_ = 0;                         // Revisions::jumps up to which groups_ knows the motion
  Revisions seen_{.structure = ~std::uint64_t(0)};  // revisions at the last look at what follows others
  std::unique_ptr<ImplicitDynamics> implicit_;      // none: central differences
  WishMemory wish_memory_;
  Unreported unreported_;
  Display<Real> display_;
  Shown shown_;                      // what force terms saw of the body last
  std::map<int, double> softening_;  // softening of contact found so far, per degree of selective masses
};

extern template class Organ<float>;
extern template class Organ<double>;

}  // namespace lobe
