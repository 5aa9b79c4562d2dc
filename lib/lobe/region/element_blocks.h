// SVK tetrahedra (with or without the volume term) in blocks of one cache line: the closed-form evaluator. Each
// element writes the forces on its corners to a place of its own; each vertex then sums the places that are its
// own, in the order of a list, so that the result does not depend on threads. About 60 flops per corner. Where
// a material asks for nodal pressure, a pass over the strains comes first.
#pragma once

#include <array>
#include <vector>

#include "lobe/mesh/vertex_lists.h"
#include "lobe/parallel.h"
#include "lobe/region/nodal_pressure.h"
#include "lobe/region/wide_kernels.h"

namespace lobe {

template <class Real>
class ElementBlocks {
 public:
  explicit ElementBlocks(InstructionSet set = chosen_instruction_set()) : kernels_(wide_kernels<Real>(set)) {}

  void follow(const Elements& elements, const std::vector<Index>& leave, const std::vector<Index>& enter);

  Index tet_count() const { return static_cast<Index>(tet_of_slot_.size()); }

  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  ElementPart part,      // svk alone where κ = 0, whatever is asked
                  Parallel& parallel);
  double energy(const Mat3X<Real>& u);  // [J]

  struct Stiffness {
    double smallest_volume_ratio = 1;  // of det F over the region
    Index smallest_tet = -1;
  };
  Stiffness add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K);  // at the state u

 private:
  using Block = ElementBlock<Real>;
  using Pressures = PressureBlock<Real>;
  static constexpr int width = Block::width;

  static Index output(Index slot, int corner) {
    return 12 * width * (slot / width) + 3 * width * corner + slot % width;
  }
  ElementArrays<Real> arrays(const Mat3X<Real>& u) const {
    return {blocks_.data(), nodal_pressure_ ? pressure_blocks_.data() : nullptr, pressure_.data(), u.data()};
  }
  void find_pressures(const Mat3X<Real>& u, Parallel& parallel);
  template <class Lanes>
  void keep_slopes(const Lanes& lanes, Index begin);

  void add(const Elements& elements, Index tet);
  void remove(Index tet);
  void write(Index slot, const Shape& shape, const Elastic& elastic, double kappa,
             const Eigen::Vector4i& corners);
  void write_pressure(Index slot, double volume, const Eigen::Vector4i& nodes);
  void move(Index from, Index to);

  WideKernels<Real> kernels_;
  std::vector<Block> blocks_;
  std::vector<Index> tet_of_slot_, slot_of_tet_;
  VertexLists<Index> outputs_of_;    // per vertex: places in corner_forces_
  std::vector<Real> corner_forces_;  // scratch: per block, corner, component: one lane per tetrahedron
  bool volume_term_ = false;

  bool nodal_pressure_ = false;  // of any material; without, the rest is empty
  PressureNodes nodes_;
  std::vector<Pressures> pressure_blocks_;
  std::vector<Real> volume_strain_;  // scratch: V tr E per tetrahedron [m³]
  std::vector<Real> pressure_;       // scratch: per node [Pa]
  Mat3X<double> slopes_;             // scratch: V ∂tr E/∂u per corner of each tetrahedron [m²]
};

}  // namespace lobe
