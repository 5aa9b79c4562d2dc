// Evaluates the edge-smoothed tetrahedra of one model (fem/smoothed_edge.h) in patches of domains: one
// gather of a domain's vertices, one stress, one scatter. Volume term and guard, which act at each
// tetrahedron, are computed by domains on the way (tet_owners.h). If a material has nodal pressure, a pass
// over the strains comes first, which keeps the gradients of its domains. The domains of a patch are ordered
// by their number of vertices, so that those of a block have about as many. An edit writes the patches that
// it changes again.
#pragma once

#include <span>
#include <utility>

#include "lobe/region/edge_pressures.h"
#include "lobe/region/patch_sums.h"
#include "lobe/region/smoothed_histories.h"
#include "lobe/region/smoothed_kernels.h"
#include "lobe/region/tet_owners.h"
#include "lobe/region/viscosity.h"

namespace lobe {

template <class Real>
class SmoothedPatches {
 public:
  explicit SmoothedPatches(InstructionSet set = chosen_instruction_set(), Strain strain = Strain::finite)
      : kernels_(smoothed_kernels<Real>(set)),
        viscous_kernels_(viscous_domain_kernels<Real>(set)),
        strain_(strain) {}

  void set_paces(const Paces& paces) { paces_ = paces; }  // before any are here
  // Takes the tetrahedra of this model. Throws InputError if a domain has more vertices than a patch.
  // `copied`: tetrahedra and those that enter as their copies, with the history of their strain.
  void follow(const Elements& elements, const std::vector<Index>& leave, const std::vector<Index>& enter,
              RegionModel model = RegionModel::nonlinear, const TetPairs& copied = {});
  void add_forces(const Mat3X<Real>& u,  // 3 × #vertices [m]
                  Mat3X<Real>& f,        // 3 × #vertices [N]
                  Parallel& parallel);
  double energy(const Mat3X<Real>& u);                                                          // [J]
  void add_diagonal_stiffness(const Mat3X<Real>& u, DiagonalStiffness& K, Parallel& parallel);  // for u

  // ---- The strains of dashpots (viscosity.h), as in Patches

  Viscosity<Real>& viscosity() { return viscosity_; }
  void relax(const Elements& elements, const Mat3X<Real>& u, bool all);
  void save(std::vector<Real>& strains) const;
  bool load(std::span<const Real>& strains);

  std::size_t bytes() const;  // size of the blocks that forces are evaluated from

  template <class Visit>  // visit(layout, sums)
  void visit_patches(Visit&& visit) {
    visit(layout_, sums_);
  }

 private:
  using Layout = PatchLayout<any_number>;
  using LocalVectors = typename PatchSums<Real>::LocalVectors;
  using Block = SmoothedBlock<Real>;
  static constexpr int patch_blocks = Layout::capacity / Block::width;
  struct Patch {
    std::vector<Block> blocks;
    std::vector<GradientRow<Real>> gradients;
    std::vector<NumberRow<Real>> numbers;
    std::vector<ChainRow<Real>> chains;        // none if no domain owns tetrahedra
    std::vector<FibreBlock<Real>> fibres;      // none where no material has fibres
    std::vector<EndNodeRows<Real>> node_rows;  // none where no material has nodal pressure
    std::vector<Index> edges;                  // edges in the order of lanes
  };

  void set_laws(const Elements& elements, RegionModel model);
  bool any() const { return layout_.item_count() > 0; }
  std::vector<Layout::Item> items_of(const Elements& elements, const std::vector<Index>& edges) const;
  struct Domain {
    Index slot;
    TetChain chain;
  };
  std::vector<Domain> domains_in(const Elements& elements, Index p) const;
  void write(const Elements& elements, Index p);
  void write_lane(Patch& patch, Index block, int lane, const Domain& domain) const;
  void write_chain(const Elements& elements, Patch& patch, Index block, int lane, const Domain& domain) const;
  SmoothedArrays<Real> arrays(Index p, const LocalVectors& u) const;
  void find_pressures(const Mat3X<Real>& u, Parallel& parallel);
  std::vector<Mat3<double>> kept_gradients() const;

  void give_histories(Index p, const SmoothedHistories<Real>& histories);
  template <class Visit>
  void for_viscous(Visit&& visit) const;

  SmoothedKernels<Real> kernels_;
  ViscousDomainKernels<Real> viscous_kernels_;
  Viscosity<Real> viscosity_;
  std::vector<Index> without_history_;  // domains that are new since the last relax()
  Strain strain_;
  SmoothedEdges edges_;
  bool has_tets_ = false;  // whether tetrahedra have a volume term or a guard; without, no domain owns any
  TetOwners owners_;
  Layout layout_;
  Paces paces_;
  std::vector<Law<double>> laws_;              // law of each material
  std::vector<Layout::LocalCorners> corners_;  // corners of each slot
  std::vector<Patch> patches_;
  PatchSums<Real> sums_;         // scratch
  bool fibres_ = false;          // whether a material has fibres
  bool nodal_pressure_ = false;  // whether a material has nodal pressure; without, the rest is empty
  EdgePressures pressures_;
  std::vector<DomainGradients<Real>> gradients_;  // scratch: ∇u, patch_blocks per patch
  std::vector<Real> volume_strain_;               // scratch: V tr E per domain [m³]
  std::vector<Real> pressure_;                    // scratch: per node [Pa]
};

}  // namespace lobe
