// All regions of a body: those whose vertices move by themselves (free_regions.h), reduced and pre-computed
// ones. They share vertices at their interfaces. Whoever moves the body asks this class, and no region by
// itself. Only this class knows which tetrahedra are condensed, whether they are expanded, that is,
// non-linear for a while, and which vertices follow a lattice.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "lobe/body/loads.h"
#include "lobe/body/model.h"
#include "lobe/body/motion.h"
#include "lobe/condense/precomputed.h"
#include "lobe/forces/free_regions.h"
#include "lobe/lattice/lattice_region.h"

namespace lobe {

struct ElasticEnergy {  // [J]
  double linear = 0, nonlinear = 0;
  double condensed_loads = 0;  // −(loads that act through condensed regions and nodes) · u
};

template <class Real>
class Regions {
 public:
  Regions(const Setup& setup, const CondensingLog::Progress& condensing);

  // ---- Edits

  // follow() updates the regions that are not condensed. follow_condensed() comes next, once masses and loads
  // are up to date. It takes the loads of what becomes interior. It returns the tetrahedra that have become a
  // mechanism and must leave the region.
  void follow(const Elements& elements, const RegionEdit& edit);
  std::vector<Index> follow_condensed(const Model& model, const RegionEdit& edit, Loads<Real>& loads);
  // Whether the last edit that was followed concerned the condensed region.
  bool condensed_has_changed() const { return precomputed_.has_changed(); }
  // Throws InputError if these tetrahedra cannot get this model: what is pre-computed must be held, and its
  // matrix must not be too large; reduced ones must go with a lattice of this cell [m].
  void refuse(RegionModel model, const std::vector<Index>& tets, const Model& body,
              double lattice_cell) const;
  // Whether a region depends on what was held in between, so that a history must say so.
  bool needs_history_of_holds() const { return any_condensed(); }

  // While the region is expanded, its pre-computed tetrahedra are non-linear. After each change, masses and
  // loads of condensed_vertices() must be computed anew.
  bool can_be_expanded() const { return expandable_ && any_condensed(); }
  bool may_expand() const { return can_be_expanded() && !is_expanded_; }
  bool is_expanded() const { return is_expanded_; }
  bool can_condense() const {
    return !precomputed_.is_outdated();
  }  // no edit has changed the region since it was relinearised
  void set_expanded(bool is_expanded) { is_expanded_ = is_expanded; }
  std::vector<Index> condensed_vertices(Index vertices) const;  // shared ones first
  // Finds the mass of a condensed interior that its interface carries, after the region has changed.
  void find_carried(const Elements& elements) {
    if (!is_expanded_) precomputed_.find_carried(elements);
  }
  double carried(Index vertex) const {  // [kg]
    return any_condensed() && !is_expanded_ ? precomputed_.carried(vertex) : 0;
  }
  // After masses and loads of these vertices were computed from tetrahedra: a condensed interior gives its
  // masses to its interface, and takes over its loads. Returns those of the vertices that this concerns.
  std::vector<Index> take_over(const Elements& elements, const std::vector<Index>& vertices,
                               std::vector<double>& mass, Loads<Real>& loads) const {
    if (!any_condensed() || is_expanded_) return {};
    return precomputed_.take_over(elements, vertices, mass, loads.external(), loads.dead());
  }
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
  bool needs_condensing() const { return precomputed_.needs_condensing(); }
  bool is_condensing() const { return precomputed_.is_condensing(); }
  bool can_begin_condensing() const { return any_condensed() && !is_condensing(); }
  double condensing_due() const { return condensing_due_; }
  void begin_condensing(const Elements& elements, double due, const std::vector<double>& about);
  // False if the region could not be condensed. Nothing has changed then.
  bool end_condensing(const Elements& elements) { return precomputed_.end_condensing(elements); }
  const Mat3X<double>& linearised_about() const { return precomputed_.about(); }  // none: rest

  bool any_condensed() const { return precomputed_.tet_count() > 0; }  // tetrahedra, expanded or not
  bool is_condensed(Index tet) const { return precomputed_.has(tet); }
  bool is_interior(Index vertex) const { return any_condensed() && precomputed_.is_interior(vertex); }
  // Some vertices have no mass and follow others: an interior its interface, embedded ones their nodes.
  bool any_following() const { return (any_condensed() && !is_expanded_) || any_embedded(); }
  bool follows(Index vertex) const {
    return (!is_expanded_ && is_interior(vertex)) || reduced_.embeds(vertex);
  }
  // Whether the stiffness that a tetrahedron adds to its corners depends on it alone.
  bool are_all_of_tets() const { return !any_condensed() && !any_reduced(); }
  // Whether the model of a tetrahedron moves by itself: all but those that are condensed now.
  bool is_dynamic(const Elements& elements, Index tet) const {
    return is_expanded_ || elements.region_of[std::size_t(tet)] != RegionModel::precomputed;
  }
  const CondensingLog& condensing() const { return precomputed_.condensing(); }

  // ---- Reduced regions, whose embedded vertices follow the nodes of a lattice

  bool any_reduced() const { return reduced_.any(); }  // tetrahedra
  bool any_embedded() const { return reduced_.any_embedded(); }
  // Whether vertices follow a lattice, or may: new_roles() then says which.
  bool any_roles() const { return any_reduced() || any_embedded(); }
  // Whether energies may jump when tetrahedra get this model, since vertices are embedded or become full.
  bool is_transition(const Elements& elements, const std::vector<Index>& tets, RegionModel model) const {
    const auto is_reduced = [&](Index t) {
      return elements.region_of[std::size_t(t)] == RegionModel::reduced;
    };
    return model == RegionModel::reduced || std::any_of(tets.begin(), tets.end(), is_reduced);
  }
  // For what judges or draws them.
  LatticeRegion<Real>& reduced() { return reduced_; }
  const LatticeRegion<Real>& reduced() const { return reduced_; }

  // What vertices are to do at this time, if that is not what they do (LatticeRegion::look, roles).
  std::optional<VertexRoles> new_roles(const Model& model, const Motion<Real>& motion,
                                       const std::vector<double>& mass, FullZones::Sight sight,
                                       bool may_embed);
  // Whether energies are those of the tetrahedra that there are: false between an edit and embed().
  bool are_up_to_date() const { return reduced_.is_up_to_date(); }
  void embed(const Model& model, VertexRoles roles, double omega, std::vector<double>& mass,
             Loads<Real>& loads, Motion<Real>& motion) {
    reduced_.embed(model, std::move(roles), omega, mass, loads, motion);
  }
  const std::vector<Index>& reduced_vertices() const { return reduced_.vertices(); }
  void holds_have_changed() { reduced_.holds_have_changed(); }
  // Tetrahedra that must leave their region before these are cut.
  std::vector<Index> in_the_way(const Elements& elements, const std::vector<Index>& tets) const {
    return reduced_.in_the_way(elements, tets);
  }
  // These vertices move by themselves for that long [s] (LatticeRegion::keep_full).
  void keep_full(const Elements& elements, const std::vector<Index>& vertices, double time, double duration) {
    reduced_.keep_full(elements, vertices, time, duration);
  }
  // Masses that regions ask for, besides those of their tetrahedra [kg].
  void raise_masses(const std::vector<Index>& vertices, std::vector<double>& mass) {
    reduced_.raise_masses(vertices, mass);
  }
  double least_mass(Index vertex) const { return reduced_.least_mass(vertex); }
  typename LatticeRegion<Real>::Slowed slow_strained(const std::vector<double>& mass,
                                                     const std::function<double(Index, double)>& square,
                                                     Motion<Real>& motion) {
    return reduced_.slow_strained(mass, square, motion);
  }

  // Nodes, which move as vertices do.
  bool any_moving_nodes() const { return reduced_.any_moving(); }
  const std::vector<MovingVertex<Real>>& moving_nodes() const { return reduced_.moving(); }
  Fastest<Real> push(double kick, double dt, double damping, Motion<Real>& motion, Parallel& parallel) const {
    return reduced_.push(Real(kick), Real(dt), Real(damping), motion, parallel);
  }
  typename LatticeRegion<Real>::Frequency highest_frequency(const StateColumns<Real>& state,
                                                            const DiagonalStiffness& K, double ratio) {
    return reduced_.highest_frequency(state, K, ratio);
  }
  double kinetic_energy(const StateColumns<Real>& state) const {  // of what follows [J]
    return reduced_.kinetic_energy(state.nodes);
  }
  // Vertices on which a force term acted in the last step to no effect.
  std::vector<Index> pressed_unseen(const Motion<Real>& motion) const {
    return reduced_.pressed_unseen(motion);
  }
  // After displacements and velocities of all vertices were set: those of nodes follow from them.
  void settle(const Elements& elements, double omega, Motion<Real>& motion) {
    reduced_.settle_all(elements, omega, motion);
  }

  using State = typename LatticeRegion<Real>::State;  // part of a checkpoint
  State state(const Motion<Real>& motion) const { return reduced_.state(motion); }
  bool fits(const State& state, const Elements& elements) const { return reduced_.fits(state, elements); }
  // A state is restored in three calls. begin_restoring() returns the roles that vertices had, and in
  // `weighed` the vertices whose masses must be computed anew. embed() gives vertices these roles, if they
  // have others. end_restoring() sets the nodes and what fades.
  VertexRoles begin_restoring(const Model& model, const State& state, std::vector<Index>& weighed);
  bool has_roles(const VertexRoles& roles) const { return reduced_.has_roles(roles); }
  void end_restoring(const Elements& elements, const State& state, Motion<Real>& motion);

  // place_embedded() comes before forces are added, with velocities if force terms read them. collect() comes
  // after all other forces.
  void place_embedded(bool velocities, Motion<Real>& motion, Parallel& parallel) const {
    if (any_embedded()) reduced_.place(velocities, motion, parallel);
  }
  void collect(double missing_share, Motion<Real>& motion, Parallel& parallel) {
    if (any_embedded()) reduced_.collect(missing_share, motion, parallel);
  }

  // ---- Forces and energies. `missing_share`: share of the dead loads that does not act yet.

  void add_forces(const Mat3X<Real>& u, double missing_share, Mat3X<Real>& f,
                  Parallel& parallel);  // 3 × #vertices [N]
  // The same for small changes of a state, of which the caller takes differences: of the state at rest
  // without loads, and of any other state.
  void add_forces_near_rest(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel);
  void add_forces_near(const Mat3X<Real>& u, double missing_share, Mat3X<Real>& f, Parallel& parallel);
  // Those of all tetrahedra, as if no vertex were embedded.
  void add_tet_forces_near_rest(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel);
  // Adds the stiffness that each vertex feels when it moves while its neighbours are held. Returns the
  // smallest det F.
  SmallestVolumeRatio add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K, Parallel& parallel);
  ElasticEnergy energy(const Elements& elements, const StateColumns<Real>& state);
  // The displacement error of a condensed interior because it has no inertia, √Σ m |u|² [√kg m], at this mean
  // acceleration of the interface [m/s²].
  double inertia_error(const Vec3d& acceleration) const { return precomputed_.inertia_error(acceleration); }
  const std::vector<Index>& shared() const { return precomputed_.shared(); }  // by a condensed region
  Vec3d force_on_fixed(const Elements& elements, const Mat3X<Real>& u, Index vertex) const;

  // Computes the condensed interior, which is in equilibrium with its interface. Does nothing if the state
  // has not changed since the last call.
  enum class Interior { none, displacements, all };
  void recover(const Model& model, double missing_share, Interior wanted, StateColumns<Real>& state);

  template <class Visit>  // visit(layout, sums), of all that is evaluated in patches
  void visit_patches(Visit&& visit) {
    for_free([&](auto& region) { region.visit_patches(visit); });
    reduced_.visit_patches(visit);
    if (is_expanded_) expanded_.visit_patches(visit);
  }
  PatchCount patch_count();
  // Grows when the sums of the patches no longer are those of the last forces.
  std::uint64_t sums_revision() const { return sums_revision_; }
  void forget_sums();       // which the patches have stored
  void invalidate_sums() {  // before forces at other displacements are evaluated
    forget_sums();
    ++sums_revision_;
  }

 private:
  template <class Visit>
  void for_free(Visit&& visit) {
    std::apply([&](auto&... region) { (visit(region), ...); }, free_);
  }
  void add_free_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel);

  FreeRegions<Real> free_;
  NonlinearRegion<Real> expanded_;  // the precomputed tetrahedra, if the setup is expandable
  PrecomputedRegion<Real> precomputed_;
  LatticeRegion<Real> reduced_;
  bool expandable_;
  bool is_expanded_ = false;
  double condensing_due_ = 0;  // [s]
  Interior recovered_ = Interior::none;
  Revisions recovered_at_;
  std::uint64_t sums_revision_ = 0;
};

extern template class Regions<float>;
extern template class Regions<double>;

}  // namespace lobe
