// SVK tetrahedra (with or without the volume term) in blocks of one register width: the closed-form
// evaluator. Each element writes the forces on its corners to a place of its own; each vertex then sums the
// places that are its own, in the order of a list, so that the result does not depend on threads. About 90
// flops per corner. Where a material asks for nodal pressure, a pass over the strains comes first.
#pragma once

#include <array>
#include <vector>

#include "lobe/mesh/vertex_lists.h"
#include "lobe/parallel.h"
#include "lobe/region/nodal_pressure.h"

namespace lobe {

template <class Real>
class ElementBlocks {
 public:
  void follow(const Elements& elements, const std::vector<Index>& leave, const std::vector<Index>& enter);

  Index tet_count() const { return static_cast<Index>(tet_of_slot_.size()); }

  enum class Part { svk, volume_term, both };  // svk alone where κ = 0, whatever is asked
  void add_forces(const Mat3X<Real>& u,        // 3 × #vertices [m]
                  Mat3X<Real>& f,              // 3 × #vertices [N]
                  Part part, Parallel& parallel);
  double energy(const Mat3X<Real>& u);  // [J]

  struct Stiffness {
    double smallest_volume_ratio = 1;  // of det F over the region
    Index smallest_tet = -1;
  };
  Stiffness add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K);  // at the state u

 private:
  static constexpr int width =
      64 / sizeof(Real);  // tetrahedra per block, a multiple of every register's width
  using Row = std::array<Real, std::size_t(width)>;
  using IndexRow = std::array<std::array<Index, std::size_t(width)>, 4>;
  struct alignas(64) Block {
    std::array<Row, 9> alpha{};         // α_1, α_2, α_3 [1/m], column by column
    Row lambda_V{}, mu_V{}, kappa_V{};  // [J], λ without the share of nodal pressure; zero in empty lanes
    IndexRow corners{};
  };
  struct alignas(64) PressureBlock {  // beside each block where a material asks for nodal pressure
    Row V{};                          // [m³]
    IndexRow nodes{};                 // of the four corners
  };
  struct Lanes;  // as many tetrahedra of a block as a register holds

  static Index output(Index slot, int corner) {
    return 12 * width * (slot / width) + 3 * width * corner + slot % width;
  }
  // The kernels are flattened: all formulas inline, however often they are used elsewhere.
  template <Part part, bool nodal_pressure>
  [[gnu::flatten]] void evaluate(const Mat3X<Real>& u, Index begin, Index end);
  [[gnu::flatten]] void evaluate_strains(const Mat3X<Real>& u, Index begin, Index end);
  template <Part part>
  void evaluate_ranges(const Mat3X<Real>& u, Parallel& parallel);
  void find_pressures(const Mat3X<Real>& u, Parallel& parallel);
  void keep_slopes(const Lanes& lanes, Index begin);

  void add(const Elements& elements, Index tet);
  void remove(Index tet);
  void write(Index slot, const Shape& shape, const Elastic& elastic, double kappa,
             const Eigen::Vector4i& corners);
  void write_pressure(Index slot, double volume, const Eigen::Vector4i& nodes);
  void move(Index from, Index to);

  std::vector<Block> blocks_;
  std::vector<Index> tet_of_slot_, slot_of_tet_;
  VertexLists<Index> outputs_of_;    // per vertex: places in corner_forces_
  std::vector<Real> corner_forces_;  // scratch: per block, corner, component: one lane per tetrahedron
  bool volume_term_ = false;

  bool nodal_pressure_ = false;  // of any material; without, the rest is empty
  PressureNodes nodes_;
  std::vector<PressureBlock> pressure_blocks_;
  std::vector<Real> volume_strain_;  // scratch: V tr E per tetrahedron [m³]
  std::vector<Real> pressure_;       // scratch: per node [Pa]
  Mat3X<double> slopes_;             // scratch: V ∂tr E/∂u per corner of each tetrahedron [m²]
};

}  // namespace lobe
