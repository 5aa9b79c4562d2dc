// Selective mass scaling: inertia that grows with the wave number, so that the stable time step is longer
// (theory, section 7). The inverse mass matrix is a polynomial of a Laplacian L,
//   C = P(M⁻¹L) M⁻¹,  P(0) = 1,  0 < P ≤ 1,
// with lumped M. Motion as a whole and equilibria do not change. The method follows Olovsson, Simonsson,
// Unosson (Int. J. Numer. Meth. Engng 63, 2005), who add to the mass matrix, and Tkachuk, Bischoff (ibid.
// 101, 2015), who construct its inverse.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lobe/body/integrator.h"
#include "lobe/fem/elements.h"
#include "lobe/parallel.h"
#include "lobe/setup/boundary_conditions.h"

namespace lobe {

template <class Real>
class SelectiveMass {
 public:
  static constexpr int most = highest_mass_degree;

  // The degree of a P(a), 1 … `most`. With 1 masses are lumped.
  int degree() const { return degree_; }
  void set_degree(int degree) { degree_ = degree; }

  // Updates L around these vertices, from all alive tetrahedra that take part, with the stiffness of their
  // materials at rest. O(#tetrahedra around them).
  void follow(const Elements& elements, const std::vector<Index>& vertices,
              const std::function<bool(Index tet)>& takes_part);
  // Call it after follow() and after a change of masses, with all vertices that may move. Costs some twenty
  // products with L.
  void measure(const std::vector<MovingVertex<Real>>& free);
  // Sets which of these vertices move, while others rest.
  void set_moving(const std::vector<MovingVertex<Real>>& moving);

  // Changes forces [N] to those that give lumped masses the accelerations C f. Held components of vertices
  // that slide are left out.
  void apply(const std::vector<HeldVertices::Held>& sliding, Parallel& parallel, Mat3X<Real>& f);
  struct Acceleration {
    double norm = 0;    // √Σ m |C f|² [√kg m/s²]
    Index vertex = -1;  // vertex with the largest share of it
  };
  Acceleration acceleration() const;  // those of the last call

  // -P'(0) over the highest eigenvalue of M⁻¹L [s²]: for long waves C f is M⁻¹(f - dispersion L M⁻¹f).
  double dispersion(int degree) const;

 private:
  struct Neighbour {
    Index vertex;
    double weight;  // [N/m]
  };
  struct Row {
    std::vector<Neighbour> neighbours;
    double stiffness = 0;  // stiffness of L where only this vertex moves, before `ratio` [N/m]
    double ratio = 0;      // ratio of the body's stiffness at this vertex to that
  };
  // One neighbour of each of four consecutive vertices.
  struct Four {
    std::array<Index, 4> places;
    std::array<Real, 4> weights;
  };
  using Vectors = Eigen::Matrix<Real, 4, Eigen::Dynamic>;  // the last component is a pad

  Row find_row(const Elements& elements, Index vertex, const std::function<bool(Index)>& takes_part) const;
  double weight(Index vertex, const Neighbour& neighbour) const;
  void divide(Real by);  // divides what has been arranged
  template <class Use>
  void multiply(const Vectors& x, Index begin, Index end, Use&& use) const;

  int degree_ = 1;
  std::vector<Row> rows_;  // row of each vertex
  double highest_ = 1;     // a bound of the eigenvalues of M⁻¹L [1/s²]

  // M⁻¹L over its bound, for the vertices that move, in groups of four.
  std::vector<MovingVertex<Real>> order_;
  std::vector<Index> place_of_;  // place of each vertex, −1 if it does not move
  std::vector<Index> starts_;    // starts of each four
  std::vector<Four> fours_;
  std::vector<Real> diagonal_;
  Vectors right_, now_, next_;  // scratch
};

extern template class SelectiveMass<float>;
extern template class SelectiveMass<double>;

}  // namespace lobe
