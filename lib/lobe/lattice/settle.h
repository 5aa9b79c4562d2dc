// What keeps displacements, velocities and momentum where a lattice takes over vertices, or gives them back.
#pragma once

#include "lobe/lattice/embedding.h"

namespace lobe {

// Changes the values of the nodes that are `touched` to those that come nearest to values of the embedded
// vertices, by their masses: the least Σ_i m_i |u_i − Σ_n w_n q_n|² + q·S q/ω². The second sum, of the whole
// lattice as if nothing were full, decides where a node has hardly a vertex; ω: the highest frequency of the
// full body [rad/s].
void settle(const Elements& elements, const Lattice& lattice, const Embedding& embedding,
            const std::vector<LatticeCell>& whole,     // cells of the whole lattice
            const std::vector<double>& mass,           // mass of each vertex [kg]
            double omega,                              // [rad/s]
            const std::vector<std::uint8_t>& touched,  // flag of each node
            const Mat3X<double>& u,                    // 3 × #vertices
            double tolerance,                          // bound of the squared residual, relative
            Mat3X<double>& q);                         // 3 × #nodes

// Masses in motion, and their momentum.
class MovingMasses {
 public:
  void add(double mass, const Vec3d& x, const Vec3d& v) { own_.push_back({mass, x, v}); }  // [kg], [m], [m/s]

  struct Momentum {
    Vec3d linear = Vec3d::Zero(), angular = Vec3d::Zero();  // [N s], about the origin [N m s]
    Momentum operator-(const Momentum& other) const {
      return {linear - other.linear, angular - other.angular};
    }
  };
  Momentum momentum() const;
  // The velocities of a rigid motion that gives the masses this momentum.
  struct Motion {
    Vec3d at = Vec3d::Zero(), velocity = Vec3d::Zero(), spin = Vec3d::Zero();
    Vec3d operator()(const Vec3d& x) const { return velocity + spin.cross(x - at); }
  };
  Motion moved_by(const Momentum& momentum) const;

 private:
  struct Mass {
    double mass;
    Vec3d x, v;
  };
  std::vector<Mass> own_;
};

}  // namespace lobe
