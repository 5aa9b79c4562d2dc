// Evaluates non-linear tetrahedra by the closed form of their law (fem/law.h): about 60 flops per corner for
// SVK. A patch has tetrahedra of one material (patch_layout.h, patch_sums.h). It evaluates a register's width
// of them at a time and adds their forces in the order of their slots. The memory that is read is little more
// than the tetrahedra. If a material has nodal pressure, a pass over the strains comes first.
#pragma once

#include <span>
#include <unordered_map>
#include <utility>

#include "lobe/region/nodal_pressure.h"
#include "lobe/region/patch_sums.h"
#include "lobe/region/viscosity.h"
#include "lobe/region/wide_kernels.h"

namespace lobe {

template <class Real>
class Patches {
 public:
  explicit Patches(InstructionSet set = chosen_instruction_set())
      : kernels_(wide_kernels<Real>(set)), viscous_kernels_(viscous_kernels<Real>(set)) {}

  void set_paces(const Paces& paces) { paces_ = paces; }  // before any tetrahedra are here
  // `copied`: tetrahedra and those that enter as their copies, with the history of their strain.
  void follow(const Elements& elements, const std::vector<Index>& leave, const std::vector<Index>& enter,
              RegionModel model = RegionModel::nonlinear, const TetPairs& copied = {});

  Index tet_count() const { return layout_.item_count(); }

  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel);
  double energy(const Mat3X<Real>& u);  // [J]

  template <class Visit>  // visit(layout, sums)
  void visit_patches(Visit&& visit) {
    visit(layout_, sums_);
  }

  // ---- The strains of dashpots (viscosity.h)

  Viscosity<Real>& viscosity() { return viscosity_; }
  // Puts those that entered without a history, or all, at rest in their strain.
  void relax(const Elements& elements, const Mat3X<Real>& u, bool all);
  void save(std::vector<Real>& strains) const;  // appends them
  // Takes them from the front. False if there are too few.
  bool load(std::span<const Real>& strains);

  using Stiffness = SmallestVolumeRatio;
  Stiffness add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K, Parallel& parallel);  // at u

 private:
  using Block = ElementBlock<Real>;
  using Pressures = PressureBlock<Real>;
  using Fibres = FibreBlock<Real>;
  using Layout = PatchLayout<4>;
  using LocalVectors = typename PatchSums<Real>::LocalVectors;
  static constexpr int width = Block::width, patch_blocks = Layout::capacity / width;

  void set_laws(const Elements& elements, RegionModel model);
  PatchArrays<Real> arrays(Index p, const LocalVectors& u) const;
  template <class Visit>
  void for_lanes(Index p, const Mat3X<Real>& u, Visit&& visit);
  void find_pressures(const Mat3X<Real>& u, Parallel& parallel);
  void find_slopes(const Mat3X<Real>& u);
  Stiffness smallest_of(const std::vector<Real>& ratios, const Mat3X<Real>& u);

  Layout::LocalCorners corners_in(Index slot) const;
  void remove(Index tet);
  void write(const Elements& elements, const Layout::Item& item);
  void move(Index from, Index to);
  void clear(Index slot);

  using Histories = std::unordered_map<Index, typename Viscosity<Real>::Strains>;
  Histories histories_of(const std::vector<Index>& tets) const;
  void take_histories(const std::vector<Layout::Item>& items, const Histories& histories,
                      const TetPairs& copied);
  template <class Visit>
  void for_viscous(Visit&& visit) const;

  WideKernels<Real> kernels_;
  ViscousKernels<Real> viscous_kernels_;
  Viscosity<Real> viscosity_;
  std::vector<Index> without_history_;  // entered since the last relax()
  Layout layout_;
  Paces paces_;
  std::vector<Law<double>> laws_;  // law of each material
  std::vector<Block> blocks_;      // patch_blocks per patch
  PatchSums<Real> sums_;           // scratch
  std::vector<Real> ratios_;       // scratch: smallest det F per patch

  bool fibres_ = false;  // whether a material has fibres; without, there are no blocks
  std::vector<Fibres> fibre_blocks_;

  bool nodal_pressure_ = false;  // whether a material has nodal pressure; without, the rest is empty
  PressureNodes nodes_;
  std::vector<Pressures> pressure_blocks_;
  std::vector<Real> volume_strain_;  // scratch: V tr E per tetrahedron [m³]
  std::vector<Real> pressure_;       // scratch: per node [Pa]
  Mat3X<double> slopes_;             // scratch: V ∂tr E/∂u per corner of each tetrahedron [m²]
};

}  // namespace lobe
