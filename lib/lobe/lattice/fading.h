// What a lattice cannot follow when it takes vertices over is not lost at once (theory, section 18). They
// stay where they are, and slide to their places in the lattice: vertex i moves as what is at X_i + s d_i,
//   u_i = Σ_n w_n q_n + s (d_i + Σ_n (∇w_n·d_i) q_n),   s = (1 − (t − t₀)/T)².
// So what is left of its displacement turns and stretches with the cell. The weights w_n + s ∇w_n·d_i are
// exact for linear fields, so that a force on the vertex has the same sum and moment when it goes to the
// nodes. Each new change of what is embedded begins anew, with what is left then.
#pragma once

#include <cmath>

#include "lobe/body/motion.h"
#include "lobe/lattice/embedding.h"
#include "lobe/parallel.h"

namespace lobe {

template <class Real>
class Fading {
 public:
  static constexpr double duration = 0.1;  // T [s]
  static constexpr double least = 1e-5;    // shift below which a vertex is left out, as a share of a cell

  struct State {                                   // part of a checkpoint
    double since = 0;                              // t₀ [s]
    std::vector<Index> vertices;                   // sorted
    Mat3X<Real> shifts = Mat3X<Real>::Zero(3, 0);  // shift d_i of each [m]
    bool is_valid() const {
      return std::isfinite(since) && shifts.allFinite() &&
             shifts.cols() == static_cast<Eigen::Index>(vertices.size());
    }
    static constexpr auto fields = std::tuple(&State::since, &State::vertices, &State::shifts);
  };
  State state() const;
  void set_state(const Elements& elements, const Lattice& lattice, const Embedding& embedding,
                 const State& state);

  // Begins with what the nodes do not make of the displacements of the embedded vertices. A vertex whose cell
  // is crushed so that it would be moved by more than a cell has nothing left.
  void begin(const Elements& elements, const Lattice& lattice, const Embedding& embedding,
             const StateColumns<Real>& state);
  void forget_if_over(double time) {  // gives back the memory, too
    if (any() && share(time) == 0) *this = Fading();
  }
  bool any() const { return !slides_.empty(); }

  // Adds what is left to displacements that the nodes make, and to velocities if asked for. The first: of all
  // vertices; the second: of the corners of full tetrahedra.
  void add(bool velocities, StateColumns<Real>& state) const;
  void add_at_full(bool velocities, Motion<Real>& motion, Parallel& parallel) const;
  // Adds to the forces on the nodes what follows from those on the corners of full tetrahedra.
  void add_forces(Motion<Real>& motion) const;
  // visit(vertex, what is left of its displacement [m])
  template <class Visit>
  void visit(const StateColumns<Real>& state, Visit&& visit) const {
    const Real s = share(state.time);
    for (const Slide& slide : slides_)
      visit(slide.vertex, Vec3<Real>(s * slide.image(state.nodes.u, slide.shift)));
  }
  std::array<Real, 8> change_of_weights(Index vertex, double time) const;  // s ∇w_n·d

 private:
  struct Slide {
    Index vertex = 0;
    std::array<Index, 8> nodes{};
    std::array<Real, 8> slopes{};  // ∇w_n·d
    Vec3<Real> shift;              // d [m]

    // Uses differences to the first node, as the slopes add up to zero.
    Vec3<Real> image(const Mat3X<Real>& q, Vec3<Real> sum) const {
      const Vec3<Real> first = q.col(nodes[0]);
      for (std::size_t n = 1; n < 8; ++n) sum += slopes[n] * (q.col(nodes[n]) - first);
      return sum;
    }
  };
  struct Pull {
    Index node = 0, vertex = 0;
    Real slope = 0;
  };

  Real share(double time) const;  // s
  Real rate(double time) const;   // ds/dt [1/s]
  void add(const Slide& slide, bool velocities, Real s, Real ds, StateColumns<Real>& state) const;
  void keep(const Elements& elements, const Lattice& lattice, Index vertex, const Vec3<Real>& shift);
  void list_at_full(const Embedding& embedding);

  double since_ = 0;
  std::vector<Slide> slides_;   // slides, by vertex
  std::vector<Index> at_full_;  // places in slides_ of the corners of full tetrahedra
  std::vector<Pull> pulls_;     // their forces on nodes
};

extern template class Fading<float>;
extern template class Fading<double>;

}  // namespace lobe
