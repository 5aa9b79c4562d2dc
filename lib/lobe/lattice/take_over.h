// A change of what a lattice moves: its nodes take over vertices that become embedded, and give back those
// that do not stay so. Linear and angular momentum are kept, energy is not: the part of velocities that the
// lattice cannot follow is lost; that of displacements fades (fading.h).
#pragma once

#include "lobe/body/model.h"
#include "lobe/body/motion.h"
#include "lobe/lattice/settle.h"

namespace lobe {

// Adds mass, position and velocity of the nodes with a flag in `which`, or of all nodes if it is null, to
// `sum`. node_mass: per node [kg]. nodes: displacements [m] and velocities [m/s], 3 × #nodes.
template <class Real>
void add_nodes(const Lattice& lattice, const std::vector<double>& node_mass, const Nodes<Real>& nodes,
               const std::vector<std::uint8_t>* which, MovingMasses& sum);

// Values for the nodes of a new lattice: those of the former node at the same corner.
template <class Real>
Nodes<Real> values_of(const Lattice& fresh, const Lattice& former, const Nodes<Real>& nodes);

template <class Real>
class TakeOver {
 public:
  // `whole`: cells of the whole lattice. `is_anew`: whether the lattice is a new one, with values_of() the
  // former.
  TakeOver(const Elements& elements, const Lattice& lattice, const std::vector<LatticeCell>& whole,
           const Embedding& former, const Embedding& now, bool is_anew);

  // Gives nodes the displacements and velocities that come nearest to those of the vertices, where these were
  // not embedded before.
  void settle_nodes(const std::vector<double>& mass,  // mass of each vertex [kg]
                    double omega,                     // the highest frequency of the full body [rad/s]
                    Motion<Real>& motion) const;
  // Adds a rigid motion to the velocities of what has changed, so that the momentum is that of `before`. Both
  // sums leave out what did not change: `after` has the nodes added here, and the vertices that were freed.
  void keep_momentum(const Model& model, const std::vector<double>& mass, const MovingMasses& before,
                     MovingMasses after, Motion<Real>& motion) const;

 private:
  using Flags = std::vector<std::uint8_t>;

  Flags touched_nodes() const;
  Flags changed_nodes() const;
  void begin_fresh_nodes(const Flags& fresh, const Mat3X<double>& u, Mat3X<double>& q) const;
  template <class Visit>
  void for_nodes(Index vertex, Visit&& visit) const;

  const Elements& elements_;
  const Lattice& lattice_;
  const std::vector<LatticeCell>& whole_;
  const Embedding &former_, &now_;
  bool is_anew_;
};

extern template class TakeOver<float>;
extern template class TakeOver<double>;

}  // namespace lobe
