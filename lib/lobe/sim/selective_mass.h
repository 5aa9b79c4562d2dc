// Selective mass scaling: inertia that is larger for short waves only, so that the stable time step is longer (theory,
// section 7). The inverse mass matrix is a polynomial of a scalar stiffness Laplacian L,
//   C = P(M⁻¹L) M⁻¹,  P(0) = 1,  0 < P ≤ 1,
// M lumped: what moves as a whole, and every equilibrium, is as before. Cf. Olovsson, Simonsson, Unosson, Int. J. Numer.
// Meth. Engng 63 (2005), and Tkachuk, Bischoff, ibid. 2015, who construct sparse inverse masses.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lobe/parallel.h"
#include "lobe/region/elements.h"
#include "lobe/sim/boundary_conditions.h"
#include "lobe/sim/integrator.h"

namespace lobe {

template <class Real>
class SelectiveMass {
 public:
  static constexpr int most = 16;

  // The degree of a P(a), up to `most`; 1: masses are lumped.
  int degree() const { return degree_; }
  void set_degree(int degree) { degree_ = degree; }

  // L of the tetrahedra that `take part`, on vertices whose inverse mass [1/kg] is above 0. O(#tetrahedra).
  void rebuild(const Elements& elements, const std::vector<double>& inverse_mass,
               const std::function<bool(Index tet)>& takes_part);
  // These are the ones that move, until the next call; all others stand still.
  void arrange(const std::vector<MovingVertex<Real>>& moving);

  // From forces [N] those that would accelerate lumped masses by C f. What `sliding` holds of those that move is left out.
  void apply(const std::vector<HeldVertices::Held>& sliding, Parallel& parallel, Mat3X<Real>& f);

  // -P'(0) over the largest eigenvalue of M⁻¹L [s²]: C f is M⁻¹(f - lag L M⁻¹f) for long waves.
  double lag(int degree) const;
  std::array<double, 3> defect() const;

 private:
  void find_weights(const Elements& elements, const std::vector<double>& inverse_mass,
                    const std::function<bool(Index)>& takes_part);
  void normalise(const std::vector<double>& inverse_mass);

  struct Neighbour {
    Index vertex;
    Real weight;
  };
  // One neighbour each of four vertices that lie side by side.
  struct Four {
    std::array<Index, 4> places;
    std::array<Real, 4> weights;
  };
  using Vectors = Eigen::Matrix<Real, 4, Eigen::Dynamic>;

  int degree_ = 1;
  double highest_ = 0;  // eigenvalue of M⁻¹L [1/s²]
  // M⁻¹L over a bound of its eigenvalues, per vertex.
  std::vector<Index> starts_;
  std::vector<Neighbour> neighbours_;
  std::vector<Real> diagonal_;

  // The same of those that move, in places by the number of their neighbours.
  std::vector<MovingVertex<Real>> order_;
  std::vector<Index> four_starts_, place_of_;
  std::vector<Four> fours_;
  std::vector<Real> own_;
  Vectors right_, now_, next_;
};

extern template class SelectiveMass<float>;
extern template class SelectiveMass<double>;

}  // namespace lobe
