// All regions of a body, one per kind (region_list.h). They share vertices at their interfaces. Whoever moves
// the body asks this class, and no region by itself; a step and the step limit know no kind. Only this class
// knows which tetrahedra are condensed, whether they are expanded, that is, non-linear for a while, and which
// vertices follow a lattice.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "lobe/body/loads.h"
#include "lobe/body/model.h"
#include "lobe/body/motion.h"
#include "lobe/forces/region_list.h"

namespace lobe {

struct ElasticEnergy {  // [J]
  double linear = 0, nonlinear = 0;
  double loads = 0;  // −(loads that act through condensed regions and nodes) · u
};

// Called with the finished share, 0…1, of what takes long when a body is made.
using Progress = CondensingLog::Progress;

template <class Real>
class Regions {
 public:
  Regions(const Setup& setup, const Progress& progress);

  // ---- Edits

  // follow() updates the regions that are not condensed. follow_condensed() comes next, once masses and loads
  // are up to date. It takes the loads of what becomes interior. It returns the tetrahedra that have become a
  // mechanism and must leave the region.
  void follow(const Elements& elements, const RegionEdit& edit);
  std::vector<Index> follow_condensed(const Model& model, const RegionEdit& edit, Loads<Real>& loads);
  // Lays patches out anew, by these paces.
  void lay_out(const Elements& elements, const RegionEdit& everything, const Paces& paces);
  // Throws InputError if these tetrahedra cannot get this model: what is pre-computed must be held, and its
  // matrix must not be too large; reduced ones must go with a lattice of this cell [m].
  void refuse(RegionModel model, const std::vector<Index>& tets, const Model& body,
              double lattice_cell) const;
  // Whether a region depends on what was held in between, so that a history must say so.
  bool needs_history_of_holds() const { return any_condensed(); }

  // While the region is expanded, its pre-computed tetrahedra are non-linear. After each change, masses and
  // loads of condensed_vertices() must be computed anew.
  bool can_be_expanded() const { return expandable_ && any_condensed(); }
  bool may_expand() const { return can_be_expanded() && !is_expanded(); }
  bool is_expanded() const { return precomputed().is_expanded(); }
  // Whether no edit has changed the region since it was relinearised.
  bool can_condense() const { return !precomputed().is_outdated(); }
  void set_expanded(bool is_expanded);
  std::vector<Index> condensed_vertices(Index vertices) const;                  // shared ones first
  double carried(Index vertex) const { return precomputed().carried(vertex); }  // [kg]
  // Whether a region has to change when vertices are touched, or when a blade comes near.
  bool heeds_touch() const { return any_condensed(); }
  bool heeds_blades() const { return may_expand() || any_reduced(); }
  // Whether the region should be expanded before these tetrahedra are cut.
  bool expands_for(const std::vector<Index>& tets) const {
    return may_expand() && std::any_of(tets.begin(), tets.end(), [&](Index t) { return is_condensed(t); });
  }

  // Another thread condenses the region from scratch, about its present linearisation or about other
  // displacements (3 × #vertices [m]; empty: the present ones). The result is used from the time `due` on
  // [s].
  bool is_condensing() const { return precomputed().is_condensing(); }
  bool can_begin_condensing() const { return any_condensed() && !is_condensing(); }
  double condensing_due() const { return condensing_due_; }
  void begin_condensing(const Elements& elements, double due, const std::vector<double>& about);
  const Mat3X<double>& linearised_about() const { return precomputed().about(); }  // no column: rest

  bool any_condensed() const { return precomputed().tet_count() > 0; }  // expanded or not
  bool is_condensed(Index tet) const { return precomputed().has(tet); }
  bool is_interior(Index vertex) const { return any_condensed() && precomputed().is_interior(vertex); }
  // Some vertices have no mass and follow others: an interior its interface, embedded ones their nodes.
  bool any_following() const { return (any_condensed() && !is_expanded()) || any_embedded(); }
  bool follows(Index vertex) const {
    return (!is_expanded() && is_interior(vertex)) || reduced().embeds(vertex);
  }
  // Whether the stiffness that a tetrahedron adds to its corners depends on it alone.
  bool are_all_of_tets() const { return !any_condensed() && !any_reduced(); }
  // Whether the model of a tetrahedron moves by itself: all but those that are condensed now.
  bool is_dynamic(const Elements& elements, Index tet) const {
    return is_expanded() || elements.region_of[std::size_t(tet)] != RegionModel::precomputed;
  }
  // The model whose tetrahedra never move by themselves, if there is one.
  std::optional<RegionModel> model_without_steps() const {
    return expandable_ ? std::nullopt : std::optional(RegionModel::precomputed);
  }
  // Marks the vertices whose forces are not sums of patches, so that they are evaluated in every step.
  void mark_without_patches(const Elements& elements, std::vector<std::uint8_t>& flags) const;
  // Each mode has other frequencies at rest: 0 as the body is set up, 1 expanded.
  static constexpr std::size_t most_modes = 2;
  std::size_t mode() const { return is_expanded() ? 1 : 0; }
  bool has_modes() const { return can_be_expanded(); }
  const CondensingLog& condensing() const { return precomputed().condensing(); }

  // ---- Reduced regions, whose embedded vertices follow the nodes of a lattice

  bool any_reduced() const { return reduced().any(); }  // whether it has tetrahedra
  bool any_embedded() const { return reduced().any_embedded(); }
  // Whether vertices follow a lattice, or may.
  bool any_roles() const { return any_reduced() || any_embedded(); }
  // Whether energies may jump when tetrahedra get this model, since vertices are embedded or become full.
  bool is_transition(const Elements& elements, const std::vector<Index>& tets, RegionModel model) const {
    const auto is_reduced = [&](Index t) {
      return elements.region_of[std::size_t(t)] == RegionModel::reduced;
    };
    return model == RegionModel::reduced || std::any_of(tets.begin(), tets.end(), is_reduced);
  }
  // Single kinds of regions, for their edits and wishes, and for what judges or draws them.
  LatticeRegion<Real>& reduced() { return std::get<LatticeRegion<Real>>(list_); }
  const LatticeRegion<Real>& reduced() const { return std::get<LatticeRegion<Real>>(list_); }
  PrecomputedRegion<Real>& precomputed() { return std::get<PrecomputedRegion<Real>>(list_); }
  const PrecomputedRegion<Real>& precomputed() const { return std::get<PrecomputedRegion<Real>>(list_); }

  // Whether energies are those of the tetrahedra that there are: false between an edit and embed().
  bool are_up_to_date() const { return reduced().is_up_to_date(); }
  double least_mass(Index vertex) const { return reduced().least_mass(vertex); }  // for a moving vertex [kg]

  // Nodes, which move as vertices do.
  bool any_moving_nodes() const { return reduced().any_moving(); }
  const std::vector<MovingVertex<Real>>& moving_nodes() const { return reduced().moving(); }
  Fastest<Real> push(double kick, double dt, double damping, Motion<Real>& motion, Parallel& parallel) const {
    return reduced().push(Real(kick), Real(dt), Real(damping), motion, parallel);
  }
  typename LatticeRegion<Real>::Frequency highest_frequency(const StateColumns<Real>& state,
                                                            const DiagonalStiffness& K, double ratio) {
    return reduced().highest_frequency(state, K, ratio);
  }
  double kinetic_energy(const StateColumns<Real>& state) const {  // energy of what follows [J]
    return reduced().kinetic_energy(state.nodes);
  }
  // Vertices on which a force term acted in the last step to no effect.
  std::vector<Index> pressed_unseen(const Motion<Real>& motion) const {
    return reduced().pressed_unseen(motion);
  }

  using State = typename LatticeRegion<Real>::State;  // part of a checkpoint
  State state(const Motion<Real>& motion) const { return reduced().state(motion); }
  bool fits(const State& state, const Elements& elements) const { return reduced().fits(state, elements); }

  // ---- Viscosity: the strains of the dashpots of a Prony series (region/viscosity.h)

  // Puts dashpots of what entered in an edit without a history, or all dashpots, at rest in their strain.
  void relax_entered(const Elements& elements, const Mat3X<Real>& u) { relax(elements, u, false); }
  void relax_all(const Elements& elements, const Mat3X<Real>& u) { relax(elements, u, true); }
  // Keeps the dashpots before steps that may be taken back, and takes them back.
  void keep_dashpots() {
    visit_viscous([](auto& patches) { patches.viscosity().keep(); });
  }
  void take_back_dashpots() {
    visit_viscous([](auto& patches) { patches.viscosity().take_back(); });
  }
  std::vector<Real> dashpots() const;                   // part of a checkpoint
  bool set_dashpots(const std::vector<Real>& strains);  // false if they are those of another body

  // ---- Forces and energies. `missing_share`: share of the dead loads that does not act yet.

  // begin_forces() comes before forces are added: it places what follows others where forces read it, with
  // velocities if force terms read them. end_forces() comes after all other forces.
  void begin_forces(bool velocities, Motion<Real>& motion, Parallel& parallel) const {
    if (any_embedded()) reduced().place(velocities, motion, parallel);
  }
  void end_forces(double missing_share, Motion<Real>& motion, Parallel& parallel) {
    if (any_embedded()) reduced().collect(missing_share, motion, parallel);
  }

  void add_forces(const Mat3X<Real>& u, double missing_share, const ViscousStep& step, Mat3X<Real>& f,
                  Parallel& parallel);  // 3 × #vertices [N]
  // Forces of which differences are taken, for small changes of u: from rest, without loads; and from any
  // state. What is viscous answers at once.
  void add_forces_near_rest(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel);
  void add_forces_near(const Mat3X<Real>& u, double missing_share, Mat3X<Real>& f, Parallel& parallel);
  // The forces of all tetrahedra, as if no vertex were embedded.
  void add_tet_forces_near_rest(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel);
  // Adds the stiffness that each vertex feels when it moves while its neighbours are held. Returns the
  // smallest det F.
  SmallestVolumeRatio add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K, Parallel& parallel);
  ElasticEnergy energy(const Elements& elements, const StateColumns<Real>& state);
  const std::vector<Index>& shared() const { return precomputed().shared(); }  // condensed region's interface
  Vec3d force_on_fixed(const Elements& elements, const Mat3X<Real>& u, Index vertex) const {
    return precomputed().force_on_fixed(elements, u, vertex);
  }

  // Computes the condensed interior, which is in equilibrium with its interface. Does nothing if the state
  // has not changed since the last call.
  enum class Interior { none, displacements, all };
  void recover(const Model& model, double missing_share, Interior wanted, StateColumns<Real>& state);

  template <class Visit>  // visit(layout, sums): all that is evaluated in patches
  void visit_patches(Visit&& visit) {
    visit_regions(
        list_, [&](auto& region) -> decltype(region.visit_patches(visit)) { region.visit_patches(visit); });
  }
  PatchCount patch_count();
  // Grows when the sums of the patches no longer are those of the last forces.
  std::uint64_t sums_revision() const { return sums_revision_; }
  void forget_sums();       // forgets the sums that the patches have stored
  void invalidate_sums() {  // call it before forces at other displacements
    forget_sums();
    ++sums_revision_;
  }

 private:
  template <class Visit>
  void visit_viscous(Visit&& visit) {
    visit_regions(
        list_, [&](auto& region) -> decltype(region.visit_viscous(visit)) { region.visit_viscous(visit); });
  }
  template <class Visit>
  void visit_viscous(Visit&& visit) const {
    visit_regions(
        list_, [&](auto& region) -> decltype(region.visit_viscous(visit)) { region.visit_viscous(visit); });
  }
  void relax(const Elements& elements, const Mat3X<Real>& u, bool all) {
    visit_viscous([&](auto& patches) { patches.relax(elements, u, all); });
  }
  void set_step(const ViscousStep& step) {
    visit_viscous([&](auto& patches) { patches.viscosity().set_step(step); });
  }
  void add_forces_of_tets(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel);

  RegionList<Real> list_;
  bool expandable_;
  double condensing_due_ = 0;  // [s]
  Interior recovered_ = Interior::none;
  Revisions recovered_at_;
  std::uint64_t sums_revision_ = 0;
};

extern template class Regions<float>;
extern template class Regions<double>;

}  // namespace lobe
