// The reduced regions of a body: non-linear tetrahedra most of whose vertices follow the nodes of a lattice
// (embedding.h), so that a step evaluates cells in place of tetrahedra. Vertices move by themselves where
// they are held, shared with another region, next to such, where a cut ends, or in a zone that is full for a
// while (zones.h).
// In single precision a step costs some 30 ns per cell and 20 ns per embedded corner of full tetrahedra. The
// forces of full tetrahedra come on top.
// Forces conserve linear and angular momentum, and a rotation costs no energy.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "lobe/body/loads.h"
#include "lobe/body/model.h"
#include "lobe/body/motion.h"
#include "lobe/lattice/fading.h"
#include "lobe/lattice/lattice_cells.h"
#include "lobe/lattice/take_over.h"
#include "lobe/lattice/zone_mass.h"
#include "lobe/lattice/zones.h"
#include "lobe/region/nonlinear.h"

namespace lobe {

template <class Real>
class LatticeRegion {
 public:
  // `cell`: edge of the cells [m]; 0: chosen by choose_lattice().
  explicit LatticeRegion(double cell = 0) : cell_(cell) {}

  Index tet_count() const { return tet_count_; }
  bool has(Index tet) const { return membership(tet) == Membership::inside; }
  bool any() const { return tet_count_ > 0; }
  bool embeds(Index v) const { return embedding_.embeds(v); }
  bool any_embedded() const { return !embedding_.vertices.empty(); }
  // Corners of its tetrahedra; until embed() also those of tetrahedra that have left.
  const std::vector<Index>& vertices() const { return vertices_; }
  const Lattice& lattice() const { return lattice_; }
  const Embedding& embedding() const { return embedding_; }
  Index full_tet_count() const { return any_embedded() ? full_.tet_count() : tet_count_; }
  PatchCount past_patches() const { return past_patches_; }  // patches of regions that embed() has replaced
  // Mass added to nodes and to vertices of full tetrahedra, so that they need no shorter steps [kg].
  double mass_added() const { return mass_added_ + zone_mass_.sum(); }

  // ---- Edits

  // Takes note of tetrahedra that left or entered; embed() must follow before anything is evaluated. Throws
  // InputError for cells that do not suit the tetrahedra (choose_lattice).
  void follow(const Elements& elements, const RegionEdit& edit);
  // Finds what becomes full now, and displacements and speeds of `sight`. `mass`: per vertex [kg].
  void look(const Elements& elements, const Motion<Real>& motion, const std::vector<double>& mass,
            FullZones::Sight sight);
  // Keeps these vertices full for that long [s], from the next look() on, and longer where the tissue is not
  // smooth. Throws InputError for vertices that do not exist and for a duration that is not positive and
  // finite.
  void keep_full(const Elements& elements, const std::vector<Index>& vertices, double time, double duration);
  // Returns the reduced tetrahedra that must become non-linear before `tets` are cut: none if no reduced one
  // lies within 0.75 cells of `tets`, else all within 1.25 cells, so that further cuts there seldom add any.
  std::vector<Index> in_the_way(const Elements& elements, const std::vector<Index>& tets) const;
  // Call it when vertices are held or let go without an edit.
  void holds_have_changed() { inner_.clear(); }
  // Returns what vertices may do at a time: without `may_embed`, none is embedded.
  VertexRoles roles(const Model& model, double time, bool may_embed);
  VertexRoles roles(const Model& model, std::vector<std::uint8_t> is_embedded) const;
  bool has_roles(const VertexRoles& wanted) const { return is_up_to_date() && wanted == embedding_.roles; }
  // Whether its forces and energies are those of its tetrahedra: false from follow() to embed().
  bool is_up_to_date() const { return !is_outdated_ && !misses_tets_; }
  // Embeds these vertices and no others, and not where a cut ends. Displacements and velocities of vertices()
  // must be up to date, and masses and loads those of their tetrahedra: the nodes take them over from
  // embedded vertices. Momentum is conserved. What the nodes cannot make of the displacements fades from
  // then on (fading.h). `omega`: the highest frequency of the full body at rest [rad/s].
  void embed(const Model& model, VertexRoles wanted, double omega,
             std::vector<double>& mass,  // mass of each vertex [kg]
             Loads<Real>& loads, Motion<Real>& motion);
  // The least mass of a vertex that moves by itself, as it is now [kg].
  double least_mass(Index v) const {
    return any_embedded() ? std::max(zone_mass_.least(v, omega_), zone_mass_.asked(v)) : 0;
  }
  // Call it once masses were computed from tetrahedra: what is next to full ones gets more (zone_mass.h).
  void raise_masses(const std::vector<Index>& vertices, std::vector<double>& mass) {
    if (any_embedded()) zone_mass_.raise(embedding_, omega_, vertices, mass);
  }
  // While a lattice moves the rest, vertices that are strained so that steps would be shorter than at rest
  // have more mass from the next raise_masses() on. Each keeps its momentum. square(vertex, least) is the
  // square of the frequency by which a vertex limits the step, or 0 below `least` or if it is held [1/s²].
  struct Slowed {
    std::vector<Index> vertices;
    double kinetic = 0;  // change of their energy [J]
  };
  Slowed slow_strained(const std::vector<double>& mass, const std::function<double(Index, double)>& square,
                       Motion<Real>& motion);
  // Call it after World::set_state(): fits displacements and velocities of the nodes to those of the embedded
  // vertices, by least squares. The rest of the displacements fades.
  void settle_all(const Elements& elements, double omega, Motion<Real>& motion);

  struct State {       // part of a checkpoint
    Mat3X<Real> u, v;  // motion of nodes, 3 × #nodes [m], [m/s]
    std::vector<std::uint8_t> is_embedded;
    FullZones::State zones;
    typename Fading<Real>::State fading;
    std::vector<double> asked_mass;  // mass of strained tissue, per vertex [kg], or empty
    bool is_valid() const {
      return u.allFinite() && v.allFinite() && u.cols() == v.cols() &&
             std::all_of(asked_mass.begin(), asked_mass.end(),
                         [](double m) { return m >= 0 && std::isfinite(m); });
    }
    static constexpr auto fields = std::tuple(&State::u, &State::v, &State::is_embedded, &State::zones,
                                              &State::fading, &State::asked_mass);
  };
  State state(const Motion<Real>& motion) const;
  bool fits(const State& state, const Elements& elements) const;
  void set_zones(const FullZones::State& zones) { zones_.set_state(zones); }
  // Returns the vertices that move by themselves whose masses this changes.
  std::vector<Index> set_asked_mass(const std::vector<double>& asked);
  void set_fading(const Elements& elements, const typename Fading<Real>::State& state) {
    fading_.set_state(elements, lattice_, embedding_, state);
  }

  // ---- A step, in this order

  // Computes displacements of the embedded corners of full tetrahedra from those of the nodes, and their
  // velocities if asked for.
  void place(bool velocities, Motion<Real>& motion, Parallel& parallel) const;
  void add_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
    full().add_forces(u, f, parallel);
  }
  // Sums the forces on the nodes. `missing`: the share of the dead loads that the ramp has not applied yet.
  void collect(double missing, Motion<Real>& motion, Parallel& parallel);
  // Moves the nodes by one step of central differences.
  Fastest<Real> push(Real kick, Real dt, Real damping, Motion<Real>& motion, Parallel& parallel) const {
    return central_difference(motion.node_forces, moving_, kick, dt, damping, motion.nodes.u, motion.nodes.v,
                              motion.node_turns, parallel);
  }
  bool any_moving() const { return !moving_.empty(); }
  const std::vector<MovingVertex<Real>>& moving() const { return moving_; }  // nodes
  // Embedded vertices on which a force term acted in the last step, though no step computes where they are.
  // Such a force has no effect.
  std::vector<Index> pressed_unseen(const Motion<Real>& motion) const;

  // ---- What the lattice does not balance

  // Adds the forces of all its tetrahedra, as if no vertex were embedded: 3 × #vertices.
  void add_tet_forces(const Mat3X<Real>& u, Mat3X<Real>& f, Parallel& parallel) {
    all_.add_forces(u, f, parallel);
  }
  // The lattice's motion is that of its nodes alone: what still fades of displacements is no part of it.
  // Returns the residual of the equations of motion, 3 × #vertices [N]. Each column is turned back by the
  // rotation of the tissue around its vertex.
  // - Embedded vertex: f − m (a + γ v), with f of all tetrahedra and loads, m its own mass, and a and v
  //   the acceleration and velocity that the nodes give it.
  // - Full vertex: the force that its added mass takes up, minus the force of displacements that fade.
  // Call recover() before. `motion` must have the forces at these displacements.
  Mat3X<double> residual(const Elements& elements, const Loads<Real>& loads,
                         const std::vector<double>& own_mass,  // per vertex [kg]; further ones are left out
                         const std::vector<double>& mass,      // masses with which they move now [kg]
                         const Motion<Real>& motion, Parallel& parallel);
  // What embed() has taken from the lattice's displacements since the last call: 3 × #vertices [m], turned
  // back like residual(). From the first call on it takes note of that. Empty: nothing.
  Mat3X<Real> take_lost() {
    notes_lost_ = true;
    return std::exchange(lost_, {});
  }
  bool has_lost() const { return lost_.size() > 0; }
  // What still fades of displacements: 3 × #vertices [m], turned back like residual(). Empty: nothing.
  Mat3X<Real> fading(const StateColumns<Real>& state) const;

  // ---- Displacements, velocities and energies

  // Computes displacements of all embedded vertices, and velocities if asked for.
  void recover(const Elements& elements, bool velocities, StateColumns<Real>& state) const;
  double elastic_energy(const Mat3X<Real>& u, const Nodes<Real>& nodes);  // [J]; call place() first
  double energy_of_loads(const Nodes<Real>& nodes) const;                 // [J]
  double kinetic_energy(const Nodes<Real>& nodes) const;                  // [J]

  // The stiffness that free and embedded vertices feel from full tetrahedra.
  typename Patches<Real>::Stiffness add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K,
                                                           Parallel& parallel) {
    return full().add_diagonal_stiffness(u, K, parallel);
  }
  struct Frequency {
    double omega = 0;             // a bound of the nodes' frequencies [rad/s]
    std::vector<double> squares;  // square for each of moving() [1/s²]
    typename LatticeCells<Real>::Smallest smallest = {};
  };
  // K: of all tetrahedra around the vertices [N/m]. `ratio`: the highest frequency over the one that the
  // stiffness of single vertices gives.
  Frequency highest_frequency(const StateColumns<Real>& state, const DiagonalStiffness& K, double ratio);

  template <class Visit>
  void visit_patches(Visit&& visit) {
    all_.visit_patches(visit);
    full_.visit_patches(visit);
  }

 private:
  struct Place {  // an embedded vertex at full tetrahedra
    Index vertex = 0;
    std::array<Index, 8> nodes{};
    std::array<Real, 8> weights{};
  };
  struct Share {  // the share of a node in such a vertex
    Index vertex = 0;
    Real weight = 0;
  };

  using Flags = std::vector<std::uint8_t>;
  enum class Membership : std::uint8_t { outside, inside, freed };  // freed: non-linear now
  Membership membership(Index tet) const {
    return tet < static_cast<Index>(member_.size()) ? member_[std::size_t(tet)] : Membership::outside;
  }

  NonlinearRegion<Real>& full() { return any_embedded() ? full_ : all_; }
  Flags within(const Elements& elements, const std::vector<Index>& tets, double distance) const;

  void list_vertices(const Topology& topology);
  void ask_again_where_rough(const Elements& elements, const Motion<Real>& motion);
  void find_inner(const Model& model);
  bool is_at_cut_end(Index v) const;
  void make_lattice_anew(const Elements& elements, Nodes<Real>& nodes);
  MovingMasses in_motion_before(const Elements& elements, const Embedding& former, const VertexRoles& wanted,
                                const std::vector<double>& mass, const Motion<Real>& motion) const;
  void note_lost(const Elements& elements, const Mat3X<Real>& faded_before, const Motion<Real>& motion);
  Mat3<double> rotation_of(Index part, const Mat3X<Real>& q) const;
  void build(const Elements& elements);
  void place_interface(const Elements& elements);
  void take_loads(const Elements& elements, std::vector<double>& mass, Loads<Real>& loads);

  double cell_;
  std::vector<Membership> member_;  // one per tetrahedron
  Index tet_count_ = 0;
  std::vector<Index> vertices_;
  bool is_outdated_ = false;  // whether the lattice is
  bool misses_tets_ = false;  // whether tetrahedra have left since it was embedded
  bool notes_lost_ = false;   // whether lost displacements are noted
  Mat3X<Real> lost_;
  FullZones zones_;
  // Flags of vertices: no other region has it, nor is it next to one that boundary conditions hold, nor does
  // a cut end there; empty: not known.
  Flags inner_;
  Lattice lattice_;
  WholeLattice whole_;
  std::vector<LatticeCell> whole_cells_;  // cells of whole_
  Embedding embedding_;
  double omega_ = 0;       // the highest frequency of the full body at rest [rad/s]
  double mass_added_ = 0;  // mass added to nodes [kg]
  ZoneMass zone_mass_;
  Fading<Real> fading_;
  PatchCount past_patches_;

  // What a step reads.
  NonlinearRegion<Real> all_;   // its tetrahedra, used while no vertex is embedded
  NonlinearRegion<Real> full_;  // its full tetrahedra, used otherwise
  LatticeCells<Real> cells_;
  std::vector<Place> places_;
  std::vector<Index> shares_begin_;  // begin of each node in shares_
  std::vector<Share> shares_;
  std::vector<MovingVertex<Real>> moving_;  // nodes
  Mat3X<Real> external_, dead_;             // forces per node [N]
};

extern template class LatticeRegion<float>;
extern template class LatticeRegion<double>;

}  // namespace lobe
