// A model in motion: central differences in velocity form on lumped masses ([PDA] section 3.2 with erratum
// 3), or implicit dynamics as a reference and for stiff scenes, with regions that share vertices at their
// interfaces, tools and cuts.
//
//   World<float> world(setup);
//   while (world.time() < 2) world.advance(1.0 / 30);
#pragma once

#include <array>
#include <vector>

#include "lobe/condense/precomputed.h"
#include "lobe/cut/tet_groups.h"
#include "lobe/numerics/lanczos.h"
#include "lobe/region/nonlinear.h"
#include "lobe/region/tensor_mass.h"
#include "lobe/sim/report.h"
#include "lobe/sim/tools.h"
#include "lobe/solve/implicit_step.h"
#include "lobe/time/frequency_ratios.h"
#include "lobe/time/integrator.h"
#include "lobe/time/mass_scaling.h"
#include "lobe/time/selective_mass.h"
#include "lobe/time/sleep.h"
#include "lobe/time/unravelling.h"
#include "lobe/time/vertex_frequencies.h"

namespace lobe {

template <class Real>
struct State {
  Mat3X<Real> u;    // 3 × #vertices, displacement [m]
  Mat3X<Real> v;    // 3 × #vertices, velocity [m/s]
  double time = 0;  // [s]
  // By how much v is older than u [s]: half a step after one, 0 where motion starts, or starts anew.
  double behind = 0;
};

// The state of a world as it stands; it becomes invalid with the next cut.
template <class Real>
struct StateView {
  Eigen::Map<const Mat3X<Real>> u, v;
  double time = 0, behind = 0;
  operator State<Real>() const { return {u, v, time, behind}; }
};

// One edit of a world: tetrahedra that were removed, or that were given another model; what is held from then on, where
// a precomputed region depends on it; that this is condensed afresh, perhaps about another state, beside the simulation,
// that it goes on with the result, or that it is expanded or condensed.
struct Edit {
  enum class Kind : std::uint8_t { removal, region, held, begin_refresh, end_refresh, expand, condense };
  Kind kind = Kind::removal;
  RegionModel model = RegionModel::nonlinear;
  std::vector<Index> tets;
  HeldVertices held = {};
  double due = 0;                  // of begin_refresh: when the other follows [s]
  std::vector<double> about = {};  // of begin_refresh: it is linearised anew about these, 3 × #vertices [m]
  bool operator==(const Edit&) const = default;
};

template <class Real>
struct Checkpoint;

template <class Real>
class World {
 public:
  // Throws InputError if the setup is inconsistent, asks for a region model that is not available, or for the
  // implicit integrator in single precision.
  explicit World(const Setup& setup, int threads = 1, const CondensingLog::Progress& condensing = {});

  // Plays tools and cuts, then takes as many steps as the time step limit asks for. Tools cut at the start of
  // a frame what they will sweep during it; grasps take hold and let go on time. Throws InputError for a
  // duration that is not positive and finite, nothing else, and never leaves a NaN behind: on trouble the
  // frame is run again with smaller steps, and if that fails the displacements and velocities at its start
  // are restored (cuts stay) and the report says why.
  Report advance(double duration);  // [s], > 0
  // One step without tools, cuts and checks [s]; false if an implicit one was not solved: nothing has moved.
  bool step(double dt);

  // The interior of a precomputed region is in equilibrium with its interface; it is found here, where somebody looks,
  // and not by every step. What set_state() says of it is ignored. Not from two threads at once.
  StateView<Real> state() const;
  Eigen::Map<const Mat3X<Real>> displacements() const;  // 3 × #vertices [m]: half of the work of state()
  void set_state(const State<Real>& state);
  const Elements& elements() const { return elements_; }
  const HeldVertices& held() const { return held_; }
  const std::vector<double>& mass() const {
    return mass_;
  }  // per vertex [kg], 0 for orphans and in precomputed regions
  double time() const { return state_.time; }
  double damping() const { return setup_.damping; }  // [1/s]
  std::vector<Tools::Pose> tool_poses() const;

  // 2/ω_max at the current state [s]; infinite if nothing is free. Where nothing has moved since it was last asked for,
  // it follows cuts locally, except with nodal pressure.
  double time_step_limit();
  // The vertex estimate of ω_max, found anew. O(#tetrahedra), as is the next limit.
  VertexFrequency highest_vertex();
  const MassScaling& mass_scaling() const { return mass_scaling_; }               // what was added
  const HighestFrequency& frequency_search() const { return frequency_search_; }  // at the start
  const CondensingLog& condensing() const { return precomputed_.condensing(); }
  Eigen::Map<const Mat3X<Real>> forces();  // 3 × #vertices, internal and external, at the current state [N]
  Vec3d reaction(int holder);              // force that who holds these vertices must apply now [N]
  Energies energies();

  // Edits. Stiffness, mass, loads and boundary are updated around what changed only, but for a precomputed region that
  // must be condensed afresh (theory, section 14); whether something came loose is searched from there, and in O(#tets)
  // only where that does not tell. The time step limit is always that of the current state.
  // Alive ones; returns how many went. Loose pieces: as set up.
  Index remove_tets(const std::vector<Index>& tets);
  // Displacements and velocities stay, but for what becomes the interior of a precomputed region. Returns by how much
  // the energy has changed [J].
  double set_region(const std::vector<Index>& tets, RegionModel model);

  // Precomputed regions as non-linear ones, interior and all, until they are condensed again; displacements and velocities
  // stay, but for those of the interior when it is condensed. Only if the setup is expandable, and condensed only if no
  // edit has concerned the region since it was renewed, else InputError.
  void expand();
  void condense();
  bool is_expanded() const { return is_expanded_; }
  bool can_condense() const {
    return !precomputed_.is_outdated();
  }  // no edit concerned it since it was renewed
  bool is_expandable() const { return setup_.expandable && precomputed_.tet_count() > 0; }
  // Linearises precomputed regions anew about the present state, by another thread; goes on with the result at the first
  // frame that starts `delay` later [s], by waiting for it if need be. Until then is_renewing().
  void renew(double delay);
  bool is_renewing() const { return precomputed_.is_refreshing(); }
  // 3 × #vertices [m]; none: rest
  const Mat3X<double>& linearised_about() const { return precomputed_.about(); }
  // When the next grasp takes hold or lets go, now or later [s]; infinite: none.
  double next_grasp_change() const { return tools_.next_grasp_change(state_.time - 2e-9); }
  double lag() const;  // of a condensed interior behind its inertia, at the last forces: √Σ m |u|² [√kg m]

  // Selective mass scaling: the degree of the inverse mass (selective_mass.h), one of mass_degrees(), at the start that of
  // the setup. Between two frames; displacements stay, and of velocities all but their short waves, where the degree grows.
  // While tetrahedra are crushed, and nobody leads the body, masses are lumped whatever the degree (theory, section 8).
  int mass_degree() const { return mass_degree_; }
  std::vector<int> mass_degrees() const;  // those that there are, the last that of the setup
  void set_mass_degree(int degree);       // throws InputError for another
  // Of the last step; where masses were lumped, what this degree would leave of its accelerations.
  typename SelectiveMass<Real>::Acceleration smooth_acceleration(int degree);
  // By how much C lets these forces [N] accelerate less than M⁻¹ does, as a share of the power f·M⁻¹f, at the highest degree.
  double missing_mobility(const Mat3X<Real>& f);
  double mass_lag(int degree) const { return selective_mass_.lag(degree); }  // [s²]

  // All that this world has become (checkpoint.h). restore() throws InputError for a checkpoint of another setup, and
  // leaves the world as it was; it costs a copy where nothing was edited since, else the building of a world.
  Checkpoint<Real> save() const;
  void restore(const Checkpoint<Real>& checkpoint);
  const std::vector<Edit>& history() const { return history_; }
  Index asleep() const { return sleep_.count(); }  // vertices
  // Whether tetrahedra that stayed crushed are linear until they have come back.
  bool is_unravelling() const { return unravelling_.is_on(); }

  // The cut body as a setup of its own, from which an equal world can be built (mass scaling is found anew), and where
  // its parts come from.
  Setup current_setup(CompactMesh& compacted) const;

 private:
  using Columns = VertexColumns<Mat3X<Real>>;

  MeshEdit cut(const std::vector<Index>& tets);
  void change_region(const std::vector<Index>& tets, RegionModel model);
  void repeat(const Edit& edit);
  void follow(const MeshEdit& edit);
  void follow(RegionEdit edit);
  void add_unanchored(RegionEdit& edit);
  void refresh_held(const HeldVertices& before);
  void refresh_condensed();
  void set_expanded(bool is_expanded);
  void move_mass(const std::vector<Index>& vertices);
  void begin_refresh(double due, const std::vector<double>& about);
  void end_refresh();
  void refuse_precomputed(const std::vector<Index>& tets);
  RegionEdit change_of_region(const std::vector<Index>& tets, RegionModel model);
  void refresh_vertices(const std::vector<Index>& vertices);
  void refresh_inverse_mass(Index v);
  void find_bodies();
  Index body_of(Index tet) const { return body_of_.empty() ? 0 : body_of_[tet]; }
  void add_body(const std::vector<Index>& piece, bool was_held);
  void find_frequencies();
  template <class Weight>
  void find_frequencies(Weight&& weight);
  double weight_of(Index v) const { return inverse_mass_[std::size_t(v)] * ratios_.square(v); }
  // ω_v² [1/s²].
  double bounded_square(Index v) const { return frequencies_.bounded_square(v) / ratios_.square(v); }
  HighestFrequency search_highest(const LanczosSettings& settings);
  struct RestFrequency {
    double ratio = 1;  // ω_max / vertex estimate
    double omega = 0;  // ω_max [rad/s]
  };
  double least_ratio() const { return 1.0 / selective_mass_.degree(); }
  RestFrequency& at_rest() { return at_rest_[is_expanded_][std::size_t(selective_mass_.degree())]; }
  void measure_at_rest();
  void measure_degrees_at_rest();
  void measure_again();
  void scale_masses();
  void follow_frequencies(const MeshEdit& edit);
  CornerStiffness stiffness_of(Index tet) const;
  void add_internal_forces(const Mat3X<Real>& u, Mat3X<Real>& f);  // of the regions but the precomputed one
  std::vector<Index> touched(const Sweep& sweep);
  bool needs_all_pieces(const MeshEdit& edit);
  std::vector<std::vector<Index>> pieces_to_judge(const MeshEdit& edit);
  Index treat_loose_pieces(const std::vector<std::vector<Index>>& pieces);
  Index treat_loose_piece(const std::vector<Index>& piece);
  void check_tets(const std::vector<Index>& tets) const;
  void check_fits(const Checkpoint<Real>& checkpoint) const;
  bool is_held(Index tet) const;
  bool is_held(const std::vector<Index>& piece) const;
  void prepare_frame(double duration, Report& report);
  void advance_to(double end, Report& report);
  void play_tools(double duration, Report& report);
  void integrate(double dt);
  Fastest<Real> push(double kick, double dt);
  void leave_out_held();
  void catch_up();
  void find_moving();
  void find_inertia();
  void use_mass_degree(int degree);
  double kinetic_energy();
  void make_smooth(int degree, Mat3X<Real>& f);
  template <class Visit>
  void for_patches(Visit&& visit);  // visit(layout, sums)
  void put_loads();
  void update_sleep();
  void fall_asleep();
  bool is_still(Index vertex) const;
  void wake_pulled();
  void wake(const std::vector<Index>& vertices);
  void keep_forces();
  void forget_kept_forces();
  PatchCount patch_count();
  void unravel();
  void lump_masses();
  bool is_led() const;
  std::vector<Index> tangled_tets() const;
  bool has_come_back() const;
  void make_linear_around(std::vector<Index> tangled);
  void end_unravelling(const std::string& how);
  double ramp_at(double time) const;  // the share of what is prescribed
  Vec3d held_displacement(const HeldVertices::Held& item, double time, double ramp) const;
  void move_held(double dt);
  bool run_steps(int steps, double dt, bool first_try, Report& report);
  std::string culprit() const;
  bool implicit_step(double dt);
  double missing_loads(double time) const;  // the share of the dead loads that the ramp still holds back

  Setup initial_setup() const;

  Setup setup_;                // loads, gravity, damping …; without the mesh and its materials
  std::uint64_t fingerprint_;  // of all that it was built from
  std::vector<Edit> history_;
  Elements elements_;
  TensorMassRegion<Real> tensor_mass_;
  PrecomputedRegion<Real> precomputed_;
  double refresh_due_ = 0;  // while it is condensed afresh [s]
  NonlinearRegion<Real> nonlinear_;
  NonlinearRegion<Real> expanded_;  // the precomputed tetrahedra, if the setup is expandable
  bool is_expanded_ = false;
  DeadLoads loads_;
  Tools tools_;
  HeldVertices held_;
  std::vector<double> mass_, inverse_mass_;  // [kg], [1/kg]: 0 where held or orphan
  std::vector<double> mass_factor_;          // of mass scaling, else empty

  // What a step moves, found again where masses, holds or the state are given anew.
  std::vector<MovingVertex<Real>> moving_;  // by themselves
  std::vector<HeldVertices::Held> led_;     // held, but not at one place in all components
  bool moving_is_stale_ = true;

  SelectiveMass<Real> selective_mass_;
  int mass_degree_;                                             // used unless unravelling_.is_lumped
  std::vector<Index> inertia_edits_;                            // vertices around which it must follow
  bool inertia_is_stale_ = true, arrangement_is_stale_ = true;  // of masses; of who moves

  MassScaling mass_scaling_;
  Columns dead_loads_;  // at full size [N]
  Columns external_;    // gravity and dead loads at full size [N]
  // Measured at the start, condensed and expanded, with each degree.
  std::array<std::array<RestFrequency, SelectiveMass<Real>::most + 1>, 2> at_rest_;
  double longest_move_ = 0;  // a step that moves a vertex further is trouble [m]
  HighestFrequency frequency_search_;
  // Per tetrahedron: the piece it belonged to at the start, or since; none: all to 0.
  std::vector<Index> body_of_;
  std::vector<bool> body_was_held_;

  std::unique_ptr<ImplicitStep> implicit_;  // none: central differences
  bool implicit_is_stale_ = true;           // after an edit, or a state set from outside
  Mat3X<double> acceleration_;              // of implicit dynamics [m/s²]

  struct Moving {
    Columns u, v;
    double time = 0, behind = 0;
  };
  mutable Moving state_;
  enum class Interior { stale, displacements, all };  // of a condensed region: what of it has been recovered
  mutable Interior interior_ = Interior::all;
  Columns forces_;                       // scratch
  double fastest_ = 0, turned_ = 0;      // highest speeds of the last step (integrator.h) [m/s]
  Turns turns_;                          // since the frame began
  double fastest_held_ = 0;              // of held vertices [m/s]
  VertexFrequencies<Real> frequencies_;  // weighed with ratios_
  FrequencyRatios ratios_;
  enum class Known {  // of the frequencies
    stale,            // of another state
    followed,         // of this state, cuts followed since
    anew              // of this state: what a restored world would find, to the bit
  } known_ = Known::stale;
  Sleep sleep_;
  Unravelling unravelling_;
  double patience_ = 0;        // with a tangle [s]
  bool kept_is_stale_ = true;  // what those who sleep keep
  bool frame_begins_ = false;
  TetGroups groups_;  // for cauteries
  Index limiting_vertex_ = -1;
  double volume_ratio_ = 1;
  Index volume_ratio_tet_ = -1;
  std::vector<Condition> pending_;  // found by edits, handed out with the next report
  Parallel parallel_;
};

extern template class World<float>;
extern template class World<double>;

}  // namespace lobe
