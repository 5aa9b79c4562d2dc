// A body whose vertices are held, move by themselves or are embedded in a lattice, stepped as lobe steps:
// symplectic Euler with lumped masses and damping in proportion to them, on one thread. Tetrahedra with a
// corner that moves by itself are lobe's own patches; the others count through the cells of the lattice.
#pragma once

#include "benchmarks/reduced/cell.h"
#include "benchmarks/reduced/cell_kernel.h"
#include "benchmarks/reduced/membership.h"
#include "lobe/region/patches.h"

namespace lobe::reduced {

struct TrialSettings {
  double spacing = 0;  // of the lattice [m]
  Stiffening stiffening = Stiffening::relaxed;
  double damping = 20;  // [1/s]
};

struct TransitionCount {
  int changes = 0, relaxed_vertices = 0;  // of those freed, since a tetrahedron was crushed
  double largest_jump = 0;                // of displacements when embedding, L2 over all vertices [m]
};

template <class Real>
class TrialBody {
 public:
  // All vertices that are not held move by themselves until the first set_zone().
  TrialBody(const Body& body, const std::vector<std::uint8_t>& held, const TrialSettings& settings);

  const Elements& elements() const { return elements_; }
  // Per vertex, whether it is to move by itself from now on. The others are embedded by least squares,
  // weighed with masses, that keep the linear momentum.
  void set_zone(const std::vector<std::uint8_t>& wanted);
  double limit();  // 2/ω_max of what moves by itself, at the present state [s]
  void grasp(const std::vector<Index>& vertices) { grasped_ = vertices; }
  void step(double dt, const Mat3X<double>& targets);  // of the grasped vertices [m]
  void expand();                               // displacements and velocities of all embedded vertices
  const Mat3X<Real>& u() const { return u_; }  // of held and own vertices, of others after expand() [m]
  const TransitionCount& transitions() const { return transitions_; }
  double full_share() const;  // of the tetrahedra
  Index cell_count() const { return static_cast<Index>(active_cells_); }
  Vec3d momentum() const;                            // Σ m v of vertices and nodes [kg m/s]
  double added_mass() const { return added_mass_; }  // by the floor that the step asks for, relative

 private:
  using Nodes = std::vector<Real>;  // four numbers per node
  struct Interface {
    Index vertex;
    std::array<Index, 8> nodes;
    std::array<Real, 8> weights;
  };

  void measure_limit(double estimate);
  void list_interface();
  void build_cells();
  void find_masses();
  Mat3X<double> extrapolate(const Mat3X<Real>& full) const;
  void embed(const std::vector<Index>& vertices, const Mat3X<Real>& full, Nodes& nodes);
  void expand(const Nodes& nodes, Mat3X<Real>& full) const;
  void unravel(const std::vector<Index>& entered);
  const Cell& whole_cell(Index cell);

  Elements elements_;
  std::vector<std::uint8_t> held_;
  TrialSettings settings_;
  Lattice lattice_;
  Membership membership_;
  Patches<Real> patches_;
  Parallel parallel_{1};
  std::vector<Index> own_, used_, grasped_;
  std::vector<Interface> interface_;
  std::vector<Cell> whole_cells_;  // of all tetrahedra of a cell; volume 0: not yet made
  std::vector<CellBlock<Real>> blocks_;
  CellLaw law_;
  std::size_t active_cells_ = 0;
  std::vector<double> mass_, node_mass_, node_stiffness_;  // [kg], [kg], [N/m]
  std::vector<Real> inverse_mass_, node_inverse_;
  Mat3X<Real> u_, v_, f_;
  Nodes q_, vq_, fq_;
  DiagonalStiffness stiffness_;
  double ratio_ = 1, measured_at_ = 0;        // [1/s²]
  double rest_limit_ = 0, node_limit_ = 1e9;  // [s]
  double added_mass_ = 0;
  TransitionCount transitions_;
};

extern template class TrialBody<float>;
extern template class TrialBody<double>;

}  // namespace lobe::reduced
