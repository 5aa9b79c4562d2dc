// Inertia of a body: lumped or selective masses. It also lists the vertices that a step
// moves.
#pragma once

#include "lobe/body/loads.h"
#include "lobe/forces/regions.h"
#include "lobe/sort_unique.h"
#include "lobe/time/mass_floor.h"
#include "lobe/time/selective_mass.h"

namespace lobe {

template <class Real>
class Inertia {
 public:
  using Held = HeldVertices::Held;

  explicit Inertia(const Setup& setup)
      : highest_degree_(setup.selective_mass), degree_(setup.selective_mass) {}

  // ---- Masses

  const std::vector<double>& mass() const { return mass_; }                  // per vertex [kg], 0 for orphans
  const std::vector<double>& inverse_mass() const { return inverse_mass_; }  // [1/kg], 0 also where held
  double inverse_mass(Index v) const { return inverse_mass_[std::size_t(v)]; }

  // After an edit, update() computes masses of vertices from their tetrahedra. Call update_inverse() next.
  void update(const Model& model, const std::vector<Index>& vertices);
  // Computes the inverse mass of a vertex whose mass has changed, or that was held or released.
  void update_inverse(Model& model, Index v);
  // Masses that are changed directly: those of a condensed interior go to its interface. Then call
  // raise_to_floor().
  std::vector<double>& masses() { return mass_; }
  // Sets the mass floor, which keeps vertices at a cut from needing shorter steps. It acts on vertices that
  // are updated from now on.
  void set_floor(const MassFloor& floor) { floor_ = floor; }
  const MassFloor& floor() const { return floor_; }
  // Finds what the floor needs of each tetrahedron, ahead of the first cut. O(#tets).
  void prepare_floor(const Elements& elements);
  void raise_to_floor(const Model& model, const std::vector<Index>& vertices);
  double mass_of_floor() const { return sum_of_floor_; }  // mass that the floor has added [kg]
  // The mass on which gravity acts [kg]. Mass of the floor has no weight.
  double weighs(Index v) const {
    return mass_[std::size_t(v)] - (v < static_cast<Index>(added_.size()) ? added_[std::size_t(v)] : 0);
  }

  // ---- Vertices that move

  // Finds the vertices that a step moves, if masses, held vertices, sleeping vertices or the state have
  // changed. Vertices at rest are set here, and a step does nothing for them.
  template <class IsAsleep>
  void find_moving(const Model& model, std::uint64_t sleepers, IsAsleep&& is_asleep, Motion<Real>& motion);
  const std::vector<MovingVertex<Real>>& moving() const { return moving_; }  // free vertices
  const std::vector<Held>& driven() const { return driven_; }                // held vertices that do not rest

  // ---- Selective masses (selective_mass.h)

  bool may_be_selective() const { return highest_degree_ > 1; }
  bool is_selective() const { return selective_.degree() > 1; }
  int degree() const { return degree_; }                  // degree that was asked for
  int degree_now() const { return selective_.degree(); }  // 1 while masses are lumped for a while
  std::vector<int> degrees() const;                       // degrees that can be used; the last is the setup's
  void check_degree(int degree) const;                    // throws InputError if there is no such degree
  void ask_for(int degree) { degree_ = degree; }
  void use(int degree) { selective_.set_degree(degree); }
  // Adds vertices around which the couplings must be updated after an edit.
  void add_edits(const std::vector<Index>& vertices) {
    if (may_be_selective()) edits_.insert(edits_.end(), vertices.begin(), vertices.end());
  }

  // apply() changes forces [N] to those that give lumped masses the accelerations C f. Call find_moving(),
  // then prepare(), before it.
  template <class TakesPart>  // takes_part(tet): whether its vertices are coupled
  void prepare(const Model& model, bool any_asleep, TakesPart&& takes_part);
  void apply(Parallel& parallel, Mat3X<Real>& f) { selective_.apply(driven_, parallel, f); }
  void apply(int degree, Parallel& parallel, Mat3X<Real>& f);
  // Call it when inertia grows: v → v − (1 − P)² v. Long waves then keep their speed, and short waves keep
  // about their momentum. With their old speed short waves would swing too far.
  void slow_short_waves(Parallel& parallel, Motion<Real>& motion);
  double kinetic_energy(const StateColumns<Real>& state, Parallel& parallel) const;  // [J]
  double dispersion(int degree) const { return selective_.dispersion(degree); }      // [s²]
  typename SelectiveMass<Real>::Acceleration acceleration() const { return selective_.acceleration(); }

 private:
  std::vector<double> mass_, inverse_mass_;  // [kg], [1/kg]
  MassFloor floor_;
  std::vector<double> added_;        // mass that the floor has added [kg], or empty
  std::vector<double> tet_squares_;  // ω_T² of tetrahedra of the start [1/s²]; 0: not found yet
  double sum_of_floor_ = 0;

  std::vector<MovingVertex<Real>> moving_;
  std::vector<Held> driven_;
  Revisions moving_found_at_{.inertia = never};
  std::uint64_t sleepers_then_ = 0;

  int highest_degree_, degree_;
  SelectiveMass<Real> selective_;
  std::vector<Index> edits_;
  std::uint64_t measured_at_ = never;
  bool couplings_have_moving_ = false;

  static constexpr std::uint64_t never = ~std::uint64_t(0);
};

template <class Real>
template <class IsAsleep>
void Inertia<Real>::find_moving(const Model& model, std::uint64_t sleepers, IsAsleep&& is_asleep,
                                Motion<Real>& motion) {
  const Revisions& now = model.revisions;
  if (moving_found_at_.inertia == now.inertia && moving_found_at_.replaced == now.replaced &&
      sleepers_then_ == sleepers)
    return;
  moving_found_at_ = now;
  sleepers_then_ = sleepers;
  couplings_have_moving_ = false;
  moving_ = moving_vertices<Real>(inverse_mass_);
  std::erase_if(moving_, [&](const MovingVertex<Real>& moving) { return is_asleep(moving.vertex); });
  driven_.clear();
  for (const Held& item : model.held.all()) {
    if (item.holder != HeldVertices::boundary || item.start != item.goal || item.axes != all_axes) {
      driven_.push_back(item);
      continue;
    }
    motion.u.col(item.vertex) = item.goal.template cast<Real>();
    motion.v.col(item.vertex).setZero();
  }
}

template <class Real>
template <class TakesPart>
void Inertia<Real>::prepare(const Model& model, bool any_asleep, TakesPart&& takes_part) {
  if (measured_at_ != model.revisions.inertia) {
    sort_unique(edits_);
    selective_.follow(model.elements, edits_, takes_part);
    edits_.clear();
    selective_.measure(moving_vertices<Real>(inverse_mass_));
    couplings_have_moving_ = !any_asleep;
    measured_at_ = model.revisions.inertia;
  }
  if (!couplings_have_moving_) selective_.set_moving(moving_);
  couplings_have_moving_ = true;
}

extern template class Inertia<float>;
extern template class Inertia<double>;

}  // namespace lobe
